"""Readers of the files that explorers have, with one module for each format.

Each module has ``fits(name, content)``, which tells whether a file looks like this format, and
``read(file, content, reading)``, which makes a ``Plan`` of it or raises InputError. The message is
one line that names the file, and the line or the item with the fault. ``FORMATS`` lists the modules
in the order in which they are tried.
"""

from importlib import import_module
from pathlib import Path

from topomap.runtime.errors import InputError
from topomap.runtime.files import read_bytes
from topomap.worlds.plan import Plan, Reading
from topomap.worlds.readers.common import is_xml_with, with_names

FORMATS = {
    "graphml": "GraphML",
    "survex": "Survex",
    "map_server": "YAML of map_server",
    "trizbort": "Trizbort",
    "mapjson": "maps of topomap in JSON",
    "tmap2": "tmap2",
    "nodelink": "node-link JSON",
    "facts": "facts link(P,S,Q,R) with slots(K)",
}
IMAGES = b"\x89PNG", b"P1", b"P2", b"P3", b"P4", b"P5", b"P6", b"\xff\xd8\xff", b"GIF8", b"BM"


def read(file: str | Path, reading: Reading) -> Plan:
    """Read the plan in a file, whose content tells its format.

    Raises:
        InputError: It cannot be read. One line.
    """
    content = read_bytes(file)
    for name in FORMATS:
        reader = import_module(f"{__name__}.{name}")
        if reader.fits(Path(file).name, content):
            plan: Plan = reader.read(str(file), content, reading)
            if not plan.ways:
                raise InputError(f"{file}: no ways in it")
            return with_names(plan) if reading.landmarks else plan
    if not content.strip():
        raise InputError(f"{file}: it is empty")
    if content.startswith(IMAGES):
        raise InputError(
            f"{file}: it is an image; for a floor plan, give the YAML file that names it"
        )
    if is_xml_with(content, b"!doctype"):
        raise InputError(f"{file}: it declares a document type or entities, which is refused")
    known = ", ".join(FORMATS.values())
    raise InputError(f"{file}: it is not in one of the formats that are known: {known}")
