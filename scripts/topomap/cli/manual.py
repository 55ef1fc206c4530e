"""The manual pages, written from the parsers by ``make man``.

There is one page for ``topomap``, and one for each subcommand. What generators of such pages
leave out, the examples and the statements that follow the options in ``--help``, is written, too.
"""

import argparse
import os
import re
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from topomap.cli import whole_parser
from topomap.cli.arguments import parsers
from topomap.runtime.files import output
from topomap.runtime.version import VERSION

HEADINGS = {"example": "EXAMPLES", "exit status": "EXIT STATUS"}  # by the first words


def pages() -> dict[str, str]:
    """Write the manual pages.

    Returns:
        The text of each page, by the name of its file, such as ``topomap-solve.1``.
    """
    first = whole_parser()
    for one in parsers(first):
        one.color = False  # type: ignore[attr-defined]  # Python 3.14 colours usage in a terminal
    every = dict(_subcommands(first))
    made = {"topomap.1": page(first, [f"topomap\\-{name}(1)" for name in every])}
    for name, one in every.items():
        made[f"topomap-{name}.1"] = page(one, ["topomap(1)"])
    return made


def page(parser: argparse.ArgumentParser, others: list[str]) -> str:
    """Write the manual page of a command.

    Parameters:
        parser: The parser of the command.
        others: The pages to name under SEE ALSO.

    Returns:
        The page, in the macros of man(7).
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")  # for reproducible builds
    date = datetime.fromtimestamp(int(epoch), UTC) if epoch else datetime.now(UTC)
    name = parser.prog.replace(" ", "-")
    lines = [f'.TH {plain(name.upper())} 1 "{date:%Y-%m-%d}" "topomap {VERSION}" "topomap"']
    lines += [".SH NAME", f"{plain(name)} \\- {text(_purpose(parser))}", ".SH SYNOPSIS"]
    lines += _usage(parser)
    lines += [".SH DESCRIPTION", text(parser.description or "")]
    lines += _arguments(parser, ".SH")
    if parser.prog != "topomap":
        for one in [*parsers(parser)][1:]:
            lines += [
                f".SH {plain(one.prog.partition(' ')[2].upper())}",
                text(_purpose(one)),
                ".PP",
            ]
            lines += [*_usage(one), *_arguments(one, ".SS"), *_epilog(one, ".SS")]
    lines += [*_epilog(parser, ".SH"), ".SH SEE ALSO", ", ".join(others)]
    return "\n".join(lines) + "\n"


def plain(words: str) -> str:
    """Escape what roff would take for an instruction.

    Parameters:
        words: Some text.

    Returns:
        The text, which roff prints as it was.
    """
    escaped = words.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^(?=[.'])", r"\\&", escaped, flags=re.MULTILINE)


def text(words: str) -> str:
    """Escape running text, and write it in one line.

    Parameters:
        words: The text, in one line or several.

    Returns:
        The text, without a line that is blank.
    """
    return plain(" ".join(words.split()))


def _purpose(parser: argparse.ArgumentParser) -> str:
    """What the command is for, as a phrase without a full stop."""
    told = (parser.description or "").strip()
    return told.rstrip(".") if parser.prog == "topomap" else told[:1].lower() + told[1:].rstrip(".")


def _subcommands(
    parser: argparse.ArgumentParser,
) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """The direct subcommands of a parser, with their names."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            yield from action.choices.items()


def _usage(parser: argparse.ArgumentParser) -> list[str]:
    """The synopsis, as ``--help`` has it."""
    prefix = "usage: "
    lines = parser.format_usage().rstrip().splitlines()
    return [".nf", *(plain(line[len(prefix) :]) for line in lines), ".fi"]


def _arguments(parser: argparse.ArgumentParser, macro: str) -> Iterator[str]:
    """The arguments and options, each with its help."""
    of = {True: f"{macro} OPTIONS", False: f"{macro} ARGUMENTS"}
    formatter = parser._get_formatter()
    for is_option, heading in reversed(of.items()):
        actions = [one for one in parser._actions if bool(one.option_strings) == is_option]
        if actions:
            yield heading
        for action in actions:
            if isinstance(action, argparse._SubParsersAction):
                for choice in action._choices_actions:
                    yield from (".TP", f"\\fB{plain(choice.dest)}\\fR", text(choice.help or ""))
                continue
            yield from (".TP", f"\\fB{plain(formatter._format_action_invocation(action))}\\fR")
            yield text(formatter._expand_help(action)) if action.help else "\\&"


def _epilog(parser: argparse.ArgumentParser, macro: str) -> Iterator[str]:
    """The examples, the exit statuses, and what else stands at the end of the help."""
    told = re.split(r"\n\n", (parser.epilog or "").strip())
    for paragraph in filter(None, told):
        head, colon, rest = paragraph.partition(":")
        if colon and head in HEADINGS:
            yield f"{macro} {HEADINGS[head]}"
            paragraph = rest.strip("\n").lstrip(" ") if head == "exit status" else rest.strip("\n")
        else:
            yield f"{macro} NOTES"
        yield from (".nf", plain(paragraph), ".fi")


def main(folder: str) -> None:
    """Write the manual pages into a folder.

    Parameters:
        folder: The folder; it is made if it is not there.

    Raises:
        InputError: A file cannot be written.
    """
    os.environ["COLUMNS"] = "80"  # so that a page does not depend on the terminal
    for name, written in pages().items():
        with output(str(Path(folder) / name), parents=True) as file:
            file.write(written)


if __name__ == "__main__":
    main(*sys.argv[1:])
