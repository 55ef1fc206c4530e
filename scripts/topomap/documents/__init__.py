"""Maps as documents: reading, writing and checking them, from any source."""
