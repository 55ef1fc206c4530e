"""What is talked about: experiences, maps, queries, and their words."""
