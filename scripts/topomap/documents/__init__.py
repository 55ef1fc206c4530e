"""Maps as documents, whoever made them: they are written, read and checked."""
