"""Maps for other tools, and back."""
