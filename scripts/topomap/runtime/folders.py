"""Where the encodings and the instances are.

They are in the package if it was installed, otherwise in the checkout of this file.
"""

from pathlib import Path


def _folder(name: str) -> Path:
    package = Path(__file__).resolve().parents[1]
    installed = package / name
    return installed if installed.is_dir() else package.parents[1] / name


ENCODINGS = _folder("encodings")
INSTANCES = _folder("instances")
