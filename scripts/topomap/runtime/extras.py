"""Extras: what some commands need besides the base of the installation."""

from importlib.util import find_spec

from topomap.runtime.errors import InputError

MODULES = {
    "complete": ("shtab",),
    "draw": ("jinja2", "matplotlib", "numpy", "scipy"),
    "dask": ("distributed",),
    "floorplan": ("PIL", "numpy", "scipy", "skimage", "yaml"),
    "peers": ("aalpy",),
}


def lacking(extra: str) -> str | None:
    """Find a module of an extra that is not installed, if there is one."""
    return next((module for module in MODULES[extra] if find_spec(module) is None), None)


def need(extra: str, what: str) -> None:
    """Check that an extra is installed.

    Raises:
        InputError: It is not; one line that begins with ``what``.
    """
    if module := lacking(extra):
        raise InputError(
            f"{what}: {module} is not installed; it comes with the extra {extra}: "
            f"pip install '.[{extra}]' in the folder of topomap, "
            f"or 'FILE.whl[{extra}]' with the file of its wheel"
        )
