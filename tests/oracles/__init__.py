"""What tests hold answers against, and what makes their cases: searches and definitions that share
nothing with the package or the encodings, random worlds, and maps with errors."""
