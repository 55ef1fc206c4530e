"""clingo: everything that calls it."""
