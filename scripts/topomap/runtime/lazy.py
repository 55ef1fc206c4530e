"""Names of a package that are loaded when they are first used."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def loader(package: str, where: Mapping[str, str]) -> Callable[[str], Any]:
    """Make the ``__getattr__`` of a package.

    ``where`` tells for each name which module of topomap has it.
    """

    def load(name: str) -> Any:
        """Load the module of a name, and give what it calls so."""
        if name not in where:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f"topomap.{where[name]}"), name)
        setattr(import_module(package), name, value)
        return value

    return load
