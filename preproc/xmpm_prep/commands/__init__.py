"""The commands of xmpm-prep, one module each.

A module here is a command of its own name. It holds `HELP`, one line; `add_arguments(parser)`; and
`run(options)`, which raises `PrepError` where the input is wrong. What takes long to import (gmsh,
pyvista) is imported by the functions that need it.
"""
