"""Where each file of the repository is in the site, and the links of a page that lead there.

The pages are written for GitHub: a link is a path from the file that has it. In the site the first
page is README.md, the glossary is a page of the reference, and files such as tests, which are no
pages, are shown on pages of their own under ``source/``.
"""

import posixpath
import re
from collections.abc import Callable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ELSEWHERE = {  # files of the repository, and their pages in the site
    "README.md": "index.md",
    "docs/README.md": "pages.md",
    "docs/tutorial.ipynb": "tutorial.md",
    "encodings/README.md": "reference/glossary.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGES.md": "changes.md",
}
FENCE = re.compile(r"^(```|~~~).*?^\1[ \t]*$", re.M | re.S)
# The target of a link or a picture of Markdown, or of an element of HTML.
LINK = re.compile(r'(\]\(|\b(?:src|href)=")([^)\s"]+)([)"])')
CODE = re.compile(r"`[^`\n]*`")
# The word after the language of a block is the name of a file, which the page shows.
SHOWN = re.compile(r"^```(\w+) (\S+)$", re.M)


def place(path: str) -> str:
    """The page or file of the site for a file of the repository; both are relative paths."""
    if path in ELSEWHERE:
        return ELSEWHERE[path]
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    if path.startswith("encodings/") and path.endswith(".lp"):
        folder, name = posixpath.split(path.removeprefix("encodings/"))
        return f"reference/encodings/{folder.replace('/', '-') or 'parts'}.md#{name}"
    return f"source/{path}.md"


def targets(text: str, origin: str) -> Iterator[str]:
    """The files of the repository to which a page links that lies at ``origin``."""
    for part, prose in _parts(text):
        if prose:
            for _, link, _ in LINK.findall(CODE.sub("", part)):
                path, _ = _resolved(link, origin)
                if path:
                    yield path


def for_site(text: str, origin: str, page: str) -> str:
    """Make the text of a page of the site from that of a page of the repository.

    It lies at ``origin`` in the repository and at ``page`` in the site. Its links are made those of
    the site, and blocks that show a file get a title.
    """

    def moved(link: str) -> str:
        path, anchor = _resolved(link, origin)
        if not path:
            return link
        target, _, own = place(path).partition("#")
        heading = anchor or own
        near = posixpath.relpath(target, posixpath.dirname(page) or ".")
        return near + (f"#{heading}" if heading else "")

    def in_prose(part: str) -> str:
        def link(found: re.Match[str]) -> str:
            new = moved(found[2])
            if found[1] != "](":  # mkdocs leaves HTML as it is
                new = re.sub(r"\.md(?=#|$)", ".html", new)
            return found[1] + new + found[3]

        return _outside_code(part, lambda text: LINK.sub(link, text))

    return "".join(in_prose(part) if prose else _titled(part) for part, prose in _parts(text))


def _parts(text: str) -> Iterator[tuple[str, bool]]:
    """The pieces of a page in order, each with whether it is prose and no block of code."""
    end = 0
    for block in FENCE.finditer(text):
        yield text[end : block.start()], True
        yield block[0], False
        end = block.end()
    yield text[end:], True


def _outside_code(text: str, change: Callable[[str], str]) -> str:
    """The text changed but for `code`. A link whose words are code, [`x`](y), is changed, too."""
    kept: list[str] = []

    def hide(found: re.Match[str]) -> str:
        kept.append(found[0])
        return f"\0{len(kept) - 1}\0"

    changed = change(CODE.sub(hide, text))
    return re.sub(r"\0(\d+)\0", lambda found: kept[int(found[1])], changed)


def _titled(block: str) -> str:
    shown = SHOWN.sub(lambda found: f'```{found[1]} title="{found[2]}"', block)
    return re.sub(r"^```asp\b", "```prolog", shown)  # Pygments has no lexer for clingo's language


def _resolved(link: str, origin: str) -> tuple[str, str]:
    """Find the file of the repository to which a link leads, and the heading there.

    There is no file if the link leads out of the repository, or to a heading of the page itself.
    """
    path, _, anchor = link.partition("#")
    if not path or re.match(r"\w+:", path):
        return "", anchor
    return posixpath.normpath(posixpath.join(posixpath.dirname(origin), path)), anchor
