"""Maps that are written for other tools, and read back."""
