"""The reference of the encodings: a page for each folder, from the heads of its files."""

import html
import re
from dataclasses import dataclass
from pathlib import Path

from website.links import ROOT

FOLDERS = {  # folder of encodings/, in the order of the navigation: title, and what is in it
    "": (
        "The entry and its parts",
        "`topomap.lp` is the entry; each other file is a part, or a program of its own.",
    ),
    "theory": ("The theory", "`topomap.lp` includes these files, one concept each."),
    "online": (
        "Step by step",
        "`online.lp` includes these files. Each grounds one step after the other.",
    ),
    "phases": (
        "Phases",
        "Small programs that `topomap solve` calls first, for [large maps](../../phases.md).",
    ),
    "explore": ("Further walks", "What `explore.lp`, `unseen.lp` and `bisimilar.lp` include."),
    "paper": (
        "The paper",
        "[The theory](../../theory.md) shows these files beside the paper's sentences.",
    ),
    "paper/beyond": (
        "Beyond the paper",
        "What the paper does not know, stated as briefly as it can be.",
    ),
}
SECTION = re.compile(r"^(Input|Output|Letters|Source)\b")


@dataclass
class Head:
    """The head of an encoding.

    It says in paragraphs what the encoding is for, and has the sections Input, Output and so on,
    each as it is laid out.
    """

    name: str
    purpose: str
    more: list[str]
    sections: dict[str, str]


def head_of(text: str) -> Head:
    """The head of a file: its first comment."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("%"):
            break
        lines.append(line[1:].removeprefix(" "))
    first, *rest = lines
    name, _, begun = first.partition(" -- ")
    prose: list[list[str]] = [[begun]]
    sections: dict[str, list[str]] = {}
    current: list[str] | None = None
    for line in rest:
        if found := SECTION.match(line):
            current = sections.setdefault(found[1], [])
            after = line[found.end() :]
            current.append(re.sub(r"^\s*:?\s*", "", after) if after.strip(" :") else "")
        elif current is not None:
            if line.strip() or current[-1].strip():
                current.append(line)
        elif line.strip():
            prose[-1].append(line)
        else:
            prose.append([])
    paragraphs = ["\n".join(lines) for lines in prose if lines]
    laid = {title: "\n".join(lines).strip("\n") for title, lines in sections.items()}
    return Head(name, " ".join(paragraphs[0].split()), paragraphs[1:], laid)


def pages() -> dict[str, str]:
    """The pages, by their paths in the site."""
    return {
        f"reference/encodings/{folder.replace('/', '-') or 'parts'}.md": _page(folder)
        for folder in FOLDERS
    }


def files(folder: str) -> list[Path]:
    """The encodings of a folder, the entry first."""
    found = sorted((ROOT / "encodings" / folder).glob("*.lp"))
    return sorted(found, key=lambda path: path.name != "topomap.lp")


def _page(folder: str) -> str:
    title, about = FOLDERS[folder]
    where = f"encodings/{folder}".rstrip("/")
    text = (
        f"# {title}: `{where}/`\n\n{about} The [glossary](../glossary.md) says what each predicate "
        "means. What follows is made from the heads of the files.\n"
    )
    for path in files(folder):
        source = path.read_text(encoding="utf-8")
        head = head_of(source)
        purpose = head.purpose[:1].upper() + head.purpose[1:]
        text += f"\n## `{path.name}` {{: #{path.name} }}\n\n{_safe(purpose)}\n"
        for paragraph in head.more:
            if paragraph.startswith("  "):
                text += f"\n```text\n{_dedented(paragraph)}\n```\n"
            else:
                text += f"\n{_safe(' '.join(paragraph.split()))}\n"
        for section, said in head.sections.items():
            if section == "Source":
                text += f"\n**Source:** {_safe(' '.join(said.split()))}\n"
            else:
                text += f"\n**{section}**\n\n```text\n{_aligned(said)}\n```\n"
        body = "\n".join("    " + line if line else "" for line in source.rstrip("\n").splitlines())
        text += f'\n??? note "The file {path.name}"\n\n    ```prolog\n{body}\n    ```\n'
    return text


def _dedented(text: str) -> str:
    lines = text.splitlines()
    indent = min(len(line) - len(line.lstrip()) for line in lines if line.strip())
    return "\n".join(line[indent:] for line in lines)


def _aligned(text: str) -> str:
    """A section without the indent of its lines; its first line, beside the title, has none."""
    first, *rest = text.splitlines() or [""]
    below = _dedented("\n".join(rest)) if any(map(str.strip, rest)) else ""
    return "\n".join(part for part in (first, below) if part.strip())


def _safe(text: str) -> str:
    """A sentence of a comment in Markdown: what looks like a predicate or a file is code."""
    code = (
        r"(`[^`]*`|\b[a-z_]\w*\([^()\s]*(?:\([^()]*\))?[^()\s]*\)|\b[a-z_]+/\d\b|[\w/.{},-]*\.lp\b)"
    )
    parts = re.split(code, text)
    for number, part in enumerate(parts):
        if number % 2:
            parts[number] = part if part.startswith("`") else f"`{part}`"
        else:
            parts[number] = re.sub(r"([\\*_\[\]])", r"\\\1", html.escape(part, quote=False))
    return "".join(parts)
