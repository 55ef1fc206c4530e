"""Maps as documents: written, read, and checked, whoever made them."""
