"""The paper's figures, and some more, which are drawn into files."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from topomap.drawing.ready import ready
from topomap.runtime.errors import InputError
from topomap.runtime.extras import need
from topomap.runtime.files import output
from topomap.runtime.folders import INSTANCES
from topomap.runtime.near import meant
from topomap.runtime.watch import Watch


def figures_under(
    watch: Watch, folder: Path, names: Sequence[str] = (), instances: str | None = None
) -> Iterator[Path]:
    """Draw these figures, or all of them, into a folder, under the watch of a command.

    ``instances`` is the folder of the instances, if it is not the usual one.

    Yields:
        The path of each file when it is written.

    Raises:
        InputError: A figure is not known, or a file cannot be written. One line.
        Stopped: The command is stopped.
    """
    need("draw", "topomap figures")
    ready()
    from topomap.drawing import sheet
    from topomap.paper.figures import figures

    made = figures(Path(instances or INSTANCES), watch)
    for name in names:
        if name not in made:
            hint = f"; {near}" if (near := meant(name, made)) else ""
            raise InputError(f"{name}: the figures are {', '.join(made)}{hint}")
    for name in names or made:
        watch.title(name)
        figure = made[name]()
        watch.tick()
        path = folder / f"{name}.svg"
        with output(str(path), parents=True, binary=True) as out:
            sheet.write(figure, out, "svg")
        yield path
