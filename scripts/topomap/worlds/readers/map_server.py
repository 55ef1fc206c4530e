"""Floor plans of map_server of ROS: a YAML file, with a PNG or PGM image beside it.

Free space is where the image says so by the thresholds of the file. ``skeletons`` finds its places
and the ways between them; the places are numbered from 1, in the order of reading a page. North is
the y axis of the map: it points up in the image, apart from the third number of ``origin``, by
which the image is turned.
"""

import math
import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from topomap.runtime.errors import InputError, of_file, printable
from topomap.runtime.extras import need
from topomap.runtime.limits import LARGEST, MOST_PLACES
from topomap.worlds.courses import exit_towards, point_along, shares
from topomap.worlds.plan import Plan, Point, Reading, Way

if TYPE_CHECKING:
    from topomap.worlds.skeletons import Grid, Net

MOST_PIXELS = 40_000_000
UNKNOWN = 205  # the grey value with which map_saver writes unknown space
MOST_YAML = 2**16  # bytes
MODES = "trinary", "scale", "raw"
REQUIRED = "image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is the YAML file of a map."""
    start = content[: 2 * MOST_YAML]
    image, *others = (
        re.search(rb"(?m)(^|[{,])[ \t]*[\"']?%s[\"']?[ \t]*:" % key.encode(), start)
        for key in REQUIRED
    )
    return start.lstrip()[:1] != b"<" and bool(image) and any(others)


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan in a map.

    Raises:
        InputError: The file has a fault.
    """
    need("floorplan", file)
    from topomap.worlds import skeletons

    told = _told(file, content)
    resolution = _number(file, told, "resolution")
    if resolution <= 0:
        raise InputError(f"{file}: resolution: it must be greater than 0")
    origin = told["origin"]
    if not isinstance(origin, list) or len(origin) != 3:
        raise InputError(f"{file}: origin: it must be three numbers, [x, y, yaw]")
    east, north, yaw = (_number(file, {"origin": number}, "origin") for number in origin)
    if abs(yaw) > 2 * math.pi:
        raise InputError(f"{file}: origin: the yaw is in radians, so at most 2 pi")
    free, taken = (_number(file, told, key) for key in ("free_thresh", "occupied_thresh"))
    if not 0 <= free < taken <= 1:
        raise InputError(f"{file}: free_thresh and occupied_thresh: 0 <= free < occupied <= 1")
    negate = {"0": False, "1": True, "false": False, "true": True}.get(str(told["negate"]).lower())
    if negate is None:
        raise InputError(f"{file}: negate: it must be 0 or 1")
    mode = told.get("mode", MODES[0])
    if mode not in MODES:
        raise InputError(f"{file}: mode: it must be one of: {', '.join(MODES)}")
    image = printable(str(told["image"]))[:200]
    path, warned = _beside(file, str(told["image"]))
    grid, rows, unknown = _free_space(file, path, image, negate, free, mode)
    if unknown:
        warned.append(
            f"{file}: with free_thresh {free:g} the grey value {UNKNOWN} is free, but map_saver "
            f"writes it for what is unknown: {unknown} pixels (with free_thresh 0.196 it is not)"
        )
    if max(*grid.shape, rows) * resolution > LARGEST:
        raise InputError(f"{file}: resolution: the map is wider than {LARGEST} metres")
    radius = None if reading.radius is None else reading.radius / resolution
    try:
        net = skeletons.net_of(grid, radius, reading.loops)
    except skeletons.TooLarge as error:
        said = f"the image {image} takes too much work ({error}); make it smaller"
        raise InputError(f"{file}: {said}") from None
    if len(net.where) > MOST_PLACES:
        raise InputError(f"{file}: more than {MOST_PLACES} places")
    if not net.lines:
        said = f"no way between two places is found in the free space of the image {image}"
        raise InputError(f"{file}: {said} ({int(grid.sum())} pixels)")

    def flat(point: Any) -> Point:
        """A point of the image in the map, in metres east and north."""
        x, y = (float(point[1]) + 0.5) * resolution, (rows - float(point[0]) - 0.5) * resolution
        cos, sin = math.cos(yaw), math.sin(yaw)
        return east + cos * x - sin * y, north + sin * x + cos * y

    order = sorted(net.where, key=lambda place: (*net.where[place].round(3), place))
    number = {place: row for row, place in enumerate(order, 1)}
    points = {number[place]: flat(point) for place, point in net.where.items()}
    ways = []
    share = shares((one, other) for one, other, _ in net.lines.values())
    for one, other, line in net.lines.values():
        course = _course(net, one, other, line, flat)
        ends = [
            exit_towards(
                number[place],
                points[number[place]],
                point_along(way, reading.along + resolution * net.reach[place], share(one, other)),
            )
            for place, way in ((one, course), (other, course[::-1]))
        ]
        move = course[-1][0] - course[0][0], course[-1][1] - course[0][1]
        ways.append(Way((ends[0], ends[1]), move, sum(map(math.dist, course, course[1:]))))
    ways.sort(key=lambda way: way.ends)
    return Plan(
        Path(file).stem,
        tuple(ways),
        dict(sorted(points.items())),
        notes=(f"resolution: {resolution:g} metres a pixel",),
        told=(*warned, *_changed(file, net)),
    )


def _told(file: str, content: bytes) -> Mapping[str, Any]:
    """Read what the YAML file says.

    Tags, anchors and references are refused before any object is made.
    """
    import yaml

    if len(content) > MOST_YAML:
        raise InputError(f"{file}: larger than {MOST_YAML >> 10} KiB")
    try:
        for event in yaml.parse(content, yaml.SafeLoader):
            line = event.start_mark.line + 1 if event.start_mark else 1
            if getattr(event, "tag", None):
                raise InputError(f"{file}:{line}: YAML tags are refused")
            if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
                raise InputError(f"{file}:{line}: YAML anchors and references are refused")
        node = yaml.compose(content, yaml.SafeLoader)
        told = yaml.safe_load(content)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        reason = printable(" ".join(str(error).split()))[:200]
        raise InputError(f"{file}: not a YAML file: {reason}") from None
    if not isinstance(told, dict) or not isinstance(node, yaml.MappingNode):
        raise InputError(f"{file}: not a map of map_server: it must have keys and values")
    keys = [str(key.value) for key, _ in node.value]
    for key in REQUIRED:
        if told.get(key) is None:
            raise InputError(f"{file}: {key} is not given")
    for key in (*REQUIRED, "mode"):
        if keys.count(key) > 1:
            raise InputError(f"{file}: {key} is given twice")
    return told


def _number(file: str, told: Mapping[str, Any], key: str) -> float:
    try:
        # Some numbers are texts for YAML, such as 5e-2.
        number = math.nan if isinstance(told[key], bool) else float(told[key])
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not abs(number) <= LARGEST:
        raise InputError(f"{file}: {key}: it must be a number of at most {LARGEST}")
    return number


def _free_space(
    file: str, path: Path, image: str, negate: bool, free: float, mode: str
) -> "tuple[Grid, int, int]":
    """Find where the image beside a file is free, and how many rows it has.

    The third result is the number of free pixels with the grey value of unknown space; it is 0 if
    no free pixel is brighter. The size of the image is checked before memory is allocated for the
    pixels. What is transparent is unknown, and so not free.
    """
    import numpy as np
    from PIL import Image

    name = f"{file}: the image {image}"
    large = f"{name} has more than {MOST_PIXELS:,} pixels"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(path, formats=("PNG", "PPM")) as picture:
                if picture.width * picture.height > MOST_PIXELS:
                    raise InputError(large)
                picture.load()
                pixels = _grey(picture)
    except Image.DecompressionBombError:
        raise InputError(large) from None
    except (InputError, MemoryError):
        raise
    except OSError as error:
        if error.strerror:
            raise of_file(path, error) from None
        raise InputError(f"{name} is not a PNG or PGM image, or not a whole one") from None
    except Exception as error:  # Pillow raises all kinds of errors on bad files
        reason = printable(" ".join(str(error).split()))[:200]
        raise InputError(f"{name} cannot be read: {reason}") from None
    grey, known = pixels
    grey = np.float32(255) - grey if negate else grey
    if mode == "raw":  # the value is a probability in percent
        known &= grey <= 100
        taken = grey / 100
    else:
        taken = (255 - grey) / 255
    open_ = known & (taken < free)
    unknown = 0
    if mode != "raw" and not negate and bool((open_ & (grey > UNKNOWN)).any()):
        unknown = int((open_ & (grey == UNKNOWN)).sum())
    return open_, int(grey.shape[0]), unknown


def _grey(picture: Any) -> Any:
    """The brightness of each pixel, from 0 to 255, as the mean of its colours.

    The second result is whether each pixel is known; transparent ones are not.
    """
    import numpy as np

    if picture.mode.startswith("I"):
        grey = np.asarray(picture, dtype=np.float32) / 257
        return grey, np.ones(grey.shape, dtype=bool)
    if picture.mode in ("1", "L") and "transparency" not in picture.info:
        grey = np.asarray(picture.convert("L"), dtype=np.float32)
        return grey, np.ones(grey.shape, dtype=bool)
    colours = np.asarray(picture.convert("RGBA"))
    return colours[..., :3].mean(axis=2, dtype=np.float32), colours[..., 3] == 255


def _beside(file: str, image: str) -> tuple[Path, list[str]]:
    """The path of an image in the folder of a file, or below it, and the warnings about it.

    An absolute path that leads elsewhere may be from another machine. Then the file of the same
    name is taken that is beside this file.
    """
    if file == "-":
        raise InputError(f"{file}: its image is in its folder, so it must be given by its name")
    said = f"{file}: image: {printable(image)[:200]}"
    warned = []
    try:
        folder = Path(file).parent.resolve()
        path = (folder / image).resolve()
        if Path(image).is_absolute() and not path.is_relative_to(folder):
            path = (folder / Path(image).name).resolve()
            warned.append(f"{said} is taken to be the file of this name beside it")
        inside = path.is_relative_to(folder)
        regular = path.is_file()
    except (OSError, ValueError, RuntimeError):
        raise InputError(f"{said} is not the name of a file") from None
    if not inside:
        raise InputError(f"{said} is outside of the folder of this file")
    if not regular:
        raise InputError(f"{said} is not there, or is not a file")
    return path, warned


def _course(net: "Net", one: int, other: int, line: Any, flat: Any) -> list[Point]:
    """The course of a way from the middle of its first place to that of its second."""
    from topomap.worlds.skeletons import smooth

    width = max(2, round(min(net.free[one], net.free[other])))
    course = [flat(point) for point in smooth(line, width)]
    first, last = flat(net.where[one]), flat(net.where[other])
    return [first, *(point for point in course if point not in (first, last)), last]


def _changed(file: str, net: "Net") -> list[str]:
    """What was changed and left out, with a line for each kind."""
    return [
        f"{file}: {what}: {number}"
        for what, number in (
            ("pixels changed, as noise or as small spots", net.noise),
            ("small spots filled or cleared", net.spots),
            ("short lines pruned", net.pruned),
            ("junctions merged into others near them", net.merged),
            ("corners taken as places", net.corners),
            ("loops left out", net.loops),
            ("rings without a junction or a corner left out", net.rings),
            ("parts of free space without a way left out", net.lone),
        )
        if number
    ]
