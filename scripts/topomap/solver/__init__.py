"""clingo, wherever it is called."""
