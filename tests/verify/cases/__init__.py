"""One module a case; the name of a case is that of its module with hyphens."""
