"""What mkdocs calls when it makes the site."""

import re
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

from website import api, commands, encodings, notebook, theory
from website.links import ELSEWHERE, ROOT, for_site, place, targets

ORIGINS: dict[str, str] = {}  # pages of the site that are files of the repository
TITLES = {"Exit statuses": "Exit statuses", "The facts": "Instances"}  # of sections as pages
# What newcomers look for comes first in the search, and what they seldom look for comes last.
BOOST = {
    "index.md": 8,
    "first-questions.md": 4,
    "knowledge.md": 2,
    "reference/commands/": 0.7,
    "reference/python.md": 0.5,
    "formats.md": 0.5,
    "DEVELOPMENT.md": 0.5,
    "atlas.md": 0.5,
    "benchmark.md": 0.5,
    "solve.md": 0.5,
    "reference/encodings/": 0.3,
    "mutation.md": 0.3,
    "changes.md": 0.3,
}
LANGUAGES = {".lp": "prolog", ".py": "python", ".cff": "yaml", ".toml": "toml"}


def on_config(config: MkDocsConfig) -> None:
    """Put what is generated into the navigation, where it says so."""
    config.nav = _filled(config.nav)


def _filled(item: Any) -> Any:
    if isinstance(item, list):
        return [_filled(one) for one in item]
    if isinstance(item, dict):
        return {title: _filled(one) for title, one in item.items()}
    if item == "each command":
        every = [{"Overview": "reference/commands/index.md"}]
        return every + [{name: f"reference/commands/{name}.md"} for name in commands.names()]
    if item == "each folder of encodings":
        paths = encodings.pages()
        titles = [title for title, _ in encodings.FOLDERS.values()]
        return [{title: path} for title, path in zip(titles, paths, strict=True)]
    return item


def _named(item: Any) -> set[str]:
    """The pages that are in the navigation."""
    if isinstance(item, str):
        return {item}
    parts = item.values() if isinstance(item, dict) else item
    return {page for part in parts for page in _named(part)}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are generated, and those that are no files of docs/."""
    ORIGINS.clear()
    for path, text in _pages().items():
        files.append(File.generated(config, path, content=text))
    text, pictures = notebook.page()
    files.append(File.generated(config, "tutorial.md", content=text))
    for path, data in pictures.items():
        files.append(File.generated(config, path, content=data))
    for file in [*files]:
        if file.src_uri == "README.md":  # mkdocs would make it the first page
            files.remove(file)
        elif file.is_documentation_page() and file.generated_by is None:
            ORIGINS[file.src_uri] = f"docs/{file.src_uri}"
    ORIGINS["tutorial.md"] = "docs/tutorial.ipynb"
    named = _named(config.nav)
    for path, page in ELSEWHERE.items():
        if path != "docs/tutorial.ipynb" and (ROOT / path).is_file():
            content = (ROOT / path).read_text(encoding="utf-8")
            level = InclusionLevel.UNDEFINED if page in named else InclusionLevel.NOT_IN_NAV
            files.append(File.generated(config, page, content=content, inclusion=level))
            ORIGINS[page] = path
    for path in sorted(
        {path for page in ORIGINS for path in targets(_text(files, page), ORIGINS[page])}
    ):
        shown = place(path)
        if shown.startswith("source/") and (ROOT / path).is_file():
            files.append(
                File.generated(
                    config, shown, content=_source(path), inclusion=InclusionLevel.NOT_IN_NAV
                )
            )
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page as the site has it: links lead to pages of the site."""
    path = page.file.src_uri
    if path.startswith("source/"):  # files of the repository, to which pages link
        page.meta["search"] = {"exclude": True}
    for start, boost in BOOST.items():
        if path.startswith(start):
            page.meta["search"] = {"boost": boost}
    origin = ORIGINS.get(path)
    if origin is None:
        return markdown
    text = for_site(markdown, origin, path)
    if origin == "encodings/README.md":
        text = re.sub(r"^\|.*\|$", _linked, text, flags=re.M)
    # A table of HTML has Markdown in it, which GitHub reads without being told to.
    return re.sub(r"<(table|tr|td)>(?=<|\s*\n)", r'<\1 markdown="1">', text)


def _linked(row: re.Match[str]) -> str:
    """A row of the glossary whose last column links to the encodings."""
    before, _, last = row[0].rstrip("|").rpartition("|")

    def link(found: re.Match[str]) -> str:
        path = f"encodings/{found[1]}.lp"
        if not (ROOT / path).is_file():
            return found[0]
        return f"[{found[0]}]({place(path).removeprefix('reference/')})"

    return f"{before}|{re.sub(r'`([a-z_/]+)`', link, last)}|"


def _text(files: Files, page: str) -> str:
    file = files.get_file_from_path(page)
    assert file is not None, page
    return file.content_string


def _pages() -> dict[str, str]:
    """All that is generated as text."""
    return {
        **commands.pages(),
        **encodings.pages(),
        **theory.pages(),
        **api.pages(),
        "reference/exit-statuses.md": _section("formats", "Exit statuses"),
        "reference/instances.md": _section("writing-instances", "The facts"),
    }


def _section(page: str, heading: str) -> str:
    """A section of a page, as a page of the reference that links to it."""
    text = (ROOT / f"docs/{page}.md").read_text(encoding="utf-8")
    found = re.search(rf"^## {heading}\n(.*?)(?=^## )", text, re.M | re.S)
    if not found:
        raise ValueError(f"docs/{page}.md: no section {heading!r}")
    anchor = heading.lower().replace(" ", "-")
    moved = for_site(found[1], f"docs/{page}.md", "reference/section.md")
    whole = text.partition("\n")[0].removeprefix("# ")
    source = f"This is a section of [{whole}](../{page}.md#{anchor})."
    return f"# {TITLES[heading]}\n{moved}\n{source}\n"


def _source(path: str) -> str:
    """The page that shows a file that is no page."""
    text = (ROOT / path).read_text(encoding="utf-8")
    language = LANGUAGES.get((ROOT / path).suffix, "text")
    return f"# `{path}`\n\n~~~~{language}\n{text.rstrip()}\n~~~~\n"
