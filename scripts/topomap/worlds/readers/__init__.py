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
from topomap.worlds.readers.common import with_names

FORMATS = {
    "graphml": "a street or corridor network in GraphML, as OSMnx writes it",
    "survex": "a cave survey of Survex (.svx)",
    "map_server": "a floor plan of map_server of ROS (.yaml, with a PNG or PGM image)",
    "trizbort": "a Trizbort map",
    "mapjson": "a map in JSON, as topomap solve --json writes it",
    "tmap2": "a tmap2 of topological_navigation, in YAML",
    "nodelink": "a graph in node-link JSON, as networkx writes it",
    "facts": "facts link(P,S,Q,R), with slots(K)",
}


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
    known = "; ".join(FORMATS.values())
    raise InputError(f"{file}: it is not one of the formats that are known: {known}")
