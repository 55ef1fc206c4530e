"""What can be asked of the maps of an experience."""
