"""The reference of the commands: a page for each, from its parser."""

import argparse
import html
import importlib
import re

from topomap.cli.arguments import Parser
from topomap.cli.subcommands import SUBCOMMANDS

Sub = argparse._SubParsersAction


def pages() -> dict[str, str]:
    """The pages, by their paths in the site."""
    listed = "".join(
        f"| [`topomap {name}`]({name}.md) | {_cell(SUBCOMMANDS[name])} |\n" for name in names()
    )
    index = (
        "# Each command\n\nThese pages are made from the same text as `topomap COMMAND --help`. "
        "[Commands](../../commands.md) says what they are for, and which belong together.\n\n"
        f"| command | what it does |\n|---|---|\n{listed}\n"
        "`topomap clingo ARGS...` is clingo itself, with clingo's own options: "
        "[Plain clingo](../../plain-clingo.md).\n"
    )
    made = {f"reference/commands/{name}.md": page(name) for name in names()}
    return {"reference/commands/index.md": index, **made}


def names() -> list[str]:
    """The commands that have options of their own, in the order of the help."""
    return [name for name in SUBCOMMANDS if name != "clingo"]


def parser_of(name: str) -> argparse.ArgumentParser:
    """The parser of a command, by itself."""
    group = Parser(prog="topomap").add_subparsers()
    importlib.import_module(f"topomap.cli.{'import_' if name == 'import' else name}").add(group)
    made: argparse.ArgumentParser = group.choices[name]
    return made


def page(name: str) -> str:
    """The page of a command."""
    parser = parser_of(name)
    return (
        f"# topomap {name}\n\n{_prose(parser.description or '')}\n\n"
        f"{_usage(parser)}{_example(parser)}{_arguments(parser, [], 2)}{_kinds(parser)}"
        f"{_more(parser)}"
        "\n## Exit status\n\n[What the exit statuses mean](../exit-statuses.md) is the same for "
        "all commands.\n"
    )


def _kinds(parser: argparse.ArgumentParser) -> str:
    """Make the sections of the kinds that a command has, such as ``generate grid``.

    First come the arguments that all kinds have, then those of each kind.
    """
    kinds = [action for action in parser._actions if isinstance(action, Sub)]
    if not kinds:
        return ""
    (group,) = kinds
    subs = {sub: kind for kind, sub in group.choices.items()}
    every = [[_names(sub, action) for action in sub._actions] for sub in subs]
    common = [one for one in every[0] if all(one in of for of in every)]
    first = next(iter(subs))
    text = f"\n## In each environment\n{_arguments(first, [], 3, only=common)}"
    for sub, kind in subs.items():
        text += f"\n## {parser.prog} {kind}\n\n{_prose(sub.description or '')}.\n\n{_usage(sub)}"
        text += f"{_example(sub)}{_arguments(sub, common, 3)}"
    return text


def _names(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    """An argument as the help writes it, such as ``-o FILE, --output FILE``."""
    return parser._get_formatter()._format_action_invocation(action)


def _arguments(
    parser: argparse.ArgumentParser, without: list[str], level: int, only: list[str] | None = None
) -> str:
    """Lists of the arguments, one for each group of the help."""
    text = ""
    for group in parser._action_groups:
        told = ""
        for action in group._group_actions:
            named = _names(parser, action)
            passed = isinstance(action, Sub | argparse._HelpAction)
            if action.help == argparse.SUPPRESS or passed or named in without:
                continue
            if only is None or named in only:
                help = parser._get_formatter()._expand_help(action) if action.help else ""
                if action.choices is not None:
                    choices = ", ".join(f"`{one}`" for one in action.choices)
                    help = f"{_prose(help)} (one of {choices})" if help else f"One of {choices}."
                else:
                    help = _prose(help)
                told += f"\n`{named}`\n:   {help}\n" if help else f"\n`{named}`\n"
        if told:
            title = "Arguments" if group.title == "positional arguments" else "Options"
            text += f"\n{'#' * level} {title} {{: .plain }}\n{told}"
    return text


def _usage(parser: argparse.ArgumentParser) -> str:
    usage = re.sub(r"^usage: ", "", parser.format_usage().strip("\n"))
    usage = re.sub(r"^ {7}", "", usage, flags=re.M)
    return f"```text\n{usage}\n```\n"


def _told(parser: argparse.ArgumentParser) -> dict[str, str]:
    """What stands below the arguments in the help: the paragraphs, by their first word."""
    found = [part for part in (parser.epilog or "").split("\n\n") if part.strip()]
    return {re.split(r"\W", part, maxsplit=1)[0]: part for part in found}


def examples(parser: argparse.ArgumentParser) -> list[str]:
    """The calls that the help of a command has as examples, each as one for the shell."""
    _, _, lines = _told(parser).get("example", "").partition("\n")
    calls = [re.sub(r"^  ", "", line) for line in lines.splitlines()]
    return re.sub(r"\\\n *", "", "\n".join(calls)).splitlines()


def _example(parser: argparse.ArgumentParser) -> str:
    calls = examples(parser)
    return "\n```sh\n" + "\n".join(calls) + "\n```\n" if calls else ""


def _more(parser: argparse.ArgumentParser) -> str:
    """What else stands there, such as which statements there are."""
    told = [part for word, part in _told(parser).items() if word not in ("example", "exit")]
    return "\n## More\n" + "".join(f"\n```text\n{part}\n```\n" for part in told) if told else ""


def _prose(text: str) -> str:
    """Text of a help, safe in Markdown; options in it are code."""
    safe = re.sub(r"([\\*_|\[\]])", r"\\\1", html.escape(" ".join(text.split()), quote=False))
    return re.sub(r"(?<![\w-])(--[a-z][\w-]*)", r"`\1`", safe)


def _cell(text: str) -> str:
    return _prose(text[0].upper() + text[1:])
