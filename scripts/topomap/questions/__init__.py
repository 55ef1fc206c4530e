"""The questions that can be asked about the maps of an experience."""
