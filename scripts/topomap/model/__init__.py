"""The subject matter: experiences, maps, queries, and their words."""
