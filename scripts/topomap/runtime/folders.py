"""Where the rules and the instances are: in the package if it was installed, else in the
checkout that this file is part of."""

from pathlib import Path


def _folder(name: str) -> Path:
    package = Path(__file__).resolve().parents[1]
    installed = package / name
    return installed if installed.is_dir() else package.parents[1] / name


ENCODINGS = _folder("encodings")
INSTANCES = _folder("instances")
