"""The subcommand ``family``."""

import argparse
import contextlib
import shlex
from pathlib import Path
from typing import Any

from topomap.cli.arguments import command
from topomap.cli.generate import instance_of
from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import output, read_text
from topomap.runtime.status import DONE


def add(group: Any) -> None:
    """The parser of ``topomap family``."""
    made = command(
        group,
        "family",
        "  topomap family instances/batch.txt -d build/instances",
    )
    made.add_argument(
        "file",
        metavar="FAMILY",
        help="a family file: each line has the arguments of topomap generate for some instances",
    )
    made.add_argument(
        "-d",
        "--directory",
        required=True,
        metavar="DIR",
        help="folder for NAME.args; files of instances that are no longer listed are removed",
    )
    made.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> int:
    """Write the calls of a family that changed, and remove the files of former instances."""
    from topomap.cli import parse
    from topomap.worlds.family import expand

    folder = Path(args.directory)
    calls: dict[str, str] = {}
    for line, call in expand(args.file):
        try:
            with contextlib.redirect_stdout(None):
                parsed = parse(["generate", *call])
            if parsed.output or parsed.truth or parsed.json:
                raise InputError("-o, --truth and --json cannot be used in a family")
            made = instance_of(parsed)
        except SystemExit:
            raise InputError(f"{args.file}:{line}: --help cannot be used in a family") from None
        except InputError as error:
            raise InputError(f"{args.file}:{line}: {error}") from None
        if made.name in calls:
            raise InputError(
                f"{args.file}:{line}: a second instance named {made.name}; give it another --name"
            )
        calls[made.name] = shlex.join(call) + "\n"
        if parsed.kind in ("world", "network"):  # by this line make sees a change of the map
            is_now = Path(parsed.file).stat()
            calls[made.name] += f"# {is_now.st_size} bytes, changed {is_now.st_mtime_ns}\n"
    # What was made is listed at any time, so that a call that was cut short can be repeated.
    made_before = folder / ".family"
    old = read_text(made_before).splitlines() if made_before.exists() else []
    for name in set(old) - set(calls):
        for left in (folder / f"{name}.lp", folder / f"{name}.args"):
            if left.parent == folder:
                left.unlink(missing_ok=True)
    with output(str(made_before), parents=True) as file:
        file.writelines(f"{name}\n" for name in calls)
    for name, written in calls.items():
        path = folder / f"{name}.args"
        if not path.exists() or read_text(path) != written:
            with output(str(path)) as file:
                file.write(written)
    if args.json:
        print(formats.line({"instances": list(calls)}), end="")
    else:
        print("\n".join(calls))
    return DONE
