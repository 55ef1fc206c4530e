"""Shell completion: the script that ``topomap --print-completion SHELL`` prints.

The package shtab (https://docs.iterative.ai/shtab/) makes the script of the parser. It is loaded
only if a script is asked for, and comes with the extra ``complete``.
"""

import argparse
import re
from collections.abc import Sequence
from typing import Any

from topomap.runtime.extras import need

SHELLS = ("bash", "zsh", "tcsh")
# The metavars of arguments whose value is the name of a file, or the name of a folder.
FILES = re.compile(r"(FILE|INSTANCE|MAPS|FAMILY|WORLD|LOG)\b")
FOLDERS = re.compile(r"DIR\b")


class PrintCompletion(argparse.Action):
    """The option that prints a script for completion, and ends the command."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        """Print the script for the shell that was named.

        Raises:
            InputError: shtab is not installed; one line, which says how to install it.
            SystemExit: always in the end, with status 0.
        """
        need("complete", f"topomap {option_string}")
        print(script(str(values)))
        parser.exit()


def script(shell: str) -> str:
    """Make the script by which a shell completes the command.

    Parameters:
        shell: One of SHELLS.

    Returns:
        The text of the script.
    """
    import shtab

    from topomap.cli import whole_parser
    from topomap.cli.arguments import parsers

    parser = whole_parser()
    for one in parsers(parser):
        for action in one._actions:
            if action.choices is None and (complete := kind_of(action)):
                action.complete = complete  # type: ignore[attr-defined]  # where shtab looks
    return str(shtab.complete(parser, shell))


def kind_of(action: argparse.Action) -> dict[str, Any] | None:
    """Say how the value of an argument is completed, as shtab has it.

    Parameters:
        action: The argument.

    Returns:
        What completes files, or folders; None if the value is neither.
    """
    import shtab

    metavar = action.metavar if isinstance(action.metavar, str) else ""
    if FILES.search(metavar):
        return shtab.FILE
    return shtab.DIRECTORY if FOLDERS.search(metavar) else None
