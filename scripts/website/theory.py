"""The theory with its rules beside the paper's sentences, from the files of encodings/paper/."""

import html
import re
from collections.abc import Iterator

from website.encodings import head_of
from website.links import ROOT

PAPER = ROOT / "encodings/paper"
# The files in the order in which the paper has what they say, each with a heading.
ORDER = {
    "topomap": "Places, views and links",
    "told": "What is told",
    "path_axiom": "The path axiom",
    "paths": "Paths",
    "planar": "Planarity",
    "closed": "Closed maps",
    "travelled": "Closed, as the table counts it",
    "sides": "Left and right of a path",
    "boundary": "Consistent boundaries",
    "minimal": "Minimality",
    "perpendicular": "Perpendicularity",
    "bound": "A bound on the places",
}
INTRODUCTION = """# The theory

The left side has sentences of the paper (F. Savelli, B. Kuipers, *Loop-Closing and Planarity in
Topological Map-Building*, IROS 2004), in quotation marks, and comments of ours. The right side has
the rules that state them. A rule `a :- b, not c.` says that `a` holds if `b` holds and `c` does
not; a rule without a head, `:- b.`, forbids that `b` holds; `{ a : b } = 1` chooses exactly one
`a`. The page is made from the files of `encodings/paper/`, which are a specification: nothing in
them is for speed, and tests hold the encodings that do the work against them.

`at(9,3,2)` says that after step 9 the agent stands at gateway 2 of place 3. A place has the number
of the step that first came there, and its gateways are numbered clockwise from the one where the
agent stood then.
"""
REFERENCE = "reference/encodings/paper"


def pages() -> dict[str, str]:
    """The page, by its path in the site. Raises ValueError if a file is not in ``ORDER``."""
    there = {path.stem for path in PAPER.glob("*.lp")}
    if there != set(ORDER):
        raise ValueError(f"encodings/paper: not in the order of the page: {there ^ set(ORDER)}")
    text = INTRODUCTION
    for name, title in ORDER.items():
        source = (PAPER / f"{name}.lp").read_text(encoding="utf-8")
        purpose = head_of(source).purpose
        text += f"\n## {title}\n\n[`{name}.lp`]({REFERENCE}.md#{name}.lp): {purpose}\n"
        for said, rules in pairs(source):
            block = f"\n```prolog\n{rules}\n```\n"
            if said:
                beside = f"<div markdown>\n{_said(said)}\n</div>\n{block}"
                block = f'\n<div class="beside" markdown>\n{beside}\n</div>\n'
            text += block
    names = sorted(path.name for path in PAPER.glob("beyond/*.lp"))
    beyond = ", ".join(f"[`{name}`]({REFERENCE}-beyond.md#{name})" for name in names)
    text += (
        "\n## Beyond the paper\n\nWhat the paper does not know is stated in the same way, in "
        f"further files: {beyond}.\n"
    )
    return {"theory.md": text}


def pairs(source: str) -> Iterator[tuple[str, str]]:
    """Give the rules of a file after its head, each group of them with the comment above it.

    The comment is empty if there is none.
    """
    body = re.sub(r"\A(?:%.*\n)+", "", source)
    said: list[str] = []
    rules: list[str] = []
    for line in [*body.splitlines(), "% the end"]:
        if line.startswith("%"):
            if rules:
                yield "\n".join(said), "\n".join(rules).rstrip()
                said, rules = [], []
            said.append(line[1:].strip())
        elif line.strip() or rules:
            rules.append(line)


def _said(comment: str) -> str:
    """A comment, with where the paper says it in bold, and the paper's words in italics."""
    text = html.escape(" ".join(comment.split()), quote=False)
    text = re.sub(r"([\\*_\[\]`])", r"\\\1", text)
    text = re.sub(
        r"(?:(?<=^)|(?<=[.\"”] ))((?:Section [IV]+(?:\.[A-Z])?|Figure \d)[^:\"]*:)", r"**\1**", text
    )
    return re.sub(r'"([^"]*)"', r"*“\1”*", text)
