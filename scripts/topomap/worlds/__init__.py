"""Worlds to explore, and the instances that explorations of them give."""
