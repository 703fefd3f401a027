"""Examples of section 5 of doi:10.1002/nme.6653, run and compared with their references.

An example is a module of this package with a docstring (what the paper prints and what is run), a
text DIFFERS (where and why we differ) and a generator `reproduce(study)` that yields a Result for
each compared number. The names of the modules are in reproduction.driver.
"""
