"""topomap: exact topological map-building in answer set programming."""

__version__ = "0.2.0"
