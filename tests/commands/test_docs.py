"""The README and the pages under docs/: commands run as written and print what is said, links
lead somewhere, and figures are those of the committed reports."""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from conftest import BIN, ROOT
from topomap.paper import figure4

DOCS = ROOT / "docs"
README = ROOT / "README.md"
INDEX = DOCS / "README.md"
GALLERY = DOCS / "gallery.md"
OTHERS = [ROOT / "CONTRIBUTING.md", ROOT / "encodings/README.md"]  # pages of the site as well
PAGES = [README, *OTHERS, *sorted(DOCS.glob("**/*.md"))]
FENCE = re.compile(r"^```(\w*)(?: (\S+))?\n(.*?)^```", re.M | re.S)
SHOWN = "asp", "text", "python"  # languages of blocks that show a file, if they name one
MOST_LINES = 160  # of the README
# What tests leave to the reader, in blocks of sh: it makes environments, or takes long.
SETUP = re.compile(r"make\b|(python3? -m )?pip install |git clone |cd |export |python3 -m venv ")
SLOW = "tour88", "tour40", "topomap report", "topomap table", "tour20.lp --closed"


def test_every_block_is_found():
    """One that is indented, or has no end, would be passed over."""
    for page in PAGES:
        fences = re.findall(r"^ *```.*$", page.read_text(), re.M)
        assert len(fences) == 2 * len(FENCE.findall(page.read_text())), page
        assert not [line for line in fences if line.startswith(" ")], page


def name(page):
    return str(page.relative_to(ROOT))


def blocks(page, *languages):
    """The fenced blocks of a page in these languages: the word after the language, the text."""
    found = FENCE.findall(page.read_text())
    return [(word, text) for language, word, text in found if language in languages]


def calls(block):
    """The commands of a block, each with what it prints; lines after ``>`` belong to a command."""
    for call in re.split(r"^\$ ", block, flags=re.M)[1:]:
        first, *lines = call.splitlines(keepends=True)
        more = 0
        while more < len(lines) and lines[more].startswith("> "):
            more += 1
        command = "".join([first, *(line[2:] for line in lines[:more])])
        yield command.rstrip("\n"), "".join(lines[more:])


def cases():
    """The blocks of commands, but for those which only set up; slow ones, which are tried
    elsewhere too, are long."""
    for page in PAGES:
        for _, block in blocks(page, "console"):
            made = [*calls(block)]
            slow = any(word in command for command, _ in made for word in SLOW)
            marks = [pytest.mark.long] if slow else []
            label = f"{name(page)}: {made[0][0] if made else block}"
            yield pytest.param(page, made, id=label.splitlines()[0], marks=marks)


@pytest.mark.parametrize(("page", "commands"), [*cases()])
def test_commands_print_what_the_page_says(tmp_path, page, commands):
    """Those of a block in one folder, one after the other; ``...`` stands for any text. The
    folder has the files that the page shows, or a page to which it links. The pictures of the
    gallery are those that its commands draw."""
    for folder in ("encodings", "instances"):
        Path(tmp_path / folder).symlink_to(ROOT / folder)
    for file, text in [*shown_beside(page), *blocks(page, *SHOWN)]:
        if file:
            (tmp_path / file).write_text(text)
    assert commands
    for command, expected in commands:
        assert not SETUP.match(command), f"in a block of sh: {command}"
        done = subprocess.run(
            ["bash", "-c", command],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"},
        )
        pattern = ".*".join(re.escape(text.strip("\n")) for text in expected.split("..."))
        printed = done.stdout.strip("\n")
        assert re.fullmatch(pattern, printed, re.DOTALL), (command, printed, done.stderr)
    if page == GALLERY:
        (picture,) = tmp_path.glob("*.svg")
        drawn, committed = (folder / picture.name for folder in (tmp_path, DOCS / "gallery"))
        assert parts_of(drawn) == parts_of(committed)


def shown_beside(page):
    """The files that the pages show to which a page links."""
    linked = {path for path, _ in links(page) if path.suffix == ".md" and path.parent == DOCS}
    return [shown for one in sorted(linked) if one.exists() for shown in blocks(one, *SHOWN)]


def parts_of(picture):
    """The texts and the named parts of a picture, such as its links and faces."""
    svg = picture.read_text()
    found = re.findall(r"<text [^>]*>([^<]*)</text>", svg), re.findall(r'<g id="([\w.-]+)"', svg)
    assert all(found)
    return found


def test_the_gallery_has_twenty_pictures():
    """Each is on the page, below the command that draws it, and no other one is committed."""
    text = GALLERY.read_text()
    named = re.findall(r"^!\[[^\]]+\]\(gallery/([\w-]+\.svg)\)$", text, re.M)
    drawn = re.findall(
        r" -o ([\w-]+\.svg)\b", "".join(block for _, block in blocks(GALLERY, "console"))
    )
    assert named == drawn
    assert len(set(named)) == len(named) == 20
    assert {path.name for path in (DOCS / "gallery").iterdir()} == set(named)


def test_what_the_pages_run():
    """Enough of them; and what they do not run, in blocks of ``sh``, sets up or is a batch."""
    assert sum(len(commands) for _, commands in (case.values for case in cases())) > 60
    for page in PAGES:
        for _, block in blocks(page, "sh"):
            for line in block.splitlines():
                assert SETUP.match(line), f"{name(page)}: {line}"


def test_the_files_that_pages_show_are_used():
    for page in PAGES:
        commands = "".join(block for _, block in blocks(page, "console"))
        for file, _ in blocks(page, *SHOWN):
            assert not file or file in commands, f"{name(page)}: {file}"


def test_the_readme_is_short():
    assert len(README.read_text().splitlines()) <= MOST_LINES


def prose(page):
    """A page without its blocks and code."""
    return re.sub(r"`[^`\n]*`", "", FENCE.sub("", page.read_text()))


def links(page):
    """The files and headings of the repository that a page links to, or shows."""
    text = prose(page)
    found = re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'\b(?:src|href)="([^"]+)"', text)
    for link in found:
        if not re.match(r"\w+:", link):
            path, _, heading = link.partition("#")
            yield (page.parent / path if path else page).resolve(), heading


def headings(page):
    """The names that GitHub gives to the headings of a page."""
    found = re.findall(r"^#+ (.*)$", FENCE.sub("", page.read_text()), re.M)
    return [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found]


@pytest.mark.parametrize("page", [pytest.param(page, id=name(page)) for page in PAGES])
def test_links_lead_somewhere(page):
    for path, heading in links(page):
        assert path.exists(), f"{name(page)} links to {path.name}"
        assert not heading or heading in headings(path), f"{name(page)}: {path.name}#{heading}"


def test_the_index_leads_to_each_page():
    reached, ahead = set(), [INDEX]
    while ahead:
        page = ahead.pop()
        if page not in reached:
            reached.add(page)
            ahead += [path for path, _ in links(page) if path.suffix == ".md" and path.exists()]
    assert reached >= set(PAGES)
    assert len(PAGES) > 10


def test_the_page_for_newcomers_names_what_is_there():
    """Each file and folder, as it is called from the top, or in one of the folders within; and
    each subpackage."""
    page = (DOCS / "DEVELOPMENT.md").read_text()
    package = ROOT / "scripts/topomap"
    rooms = [path.parent for path in package.glob("*/__init__.py")]
    near = [
        ROOT / name
        for name in ("", "tests", "tests/oracles", "encodings", "instances", "scripts/website")
    ]
    named = set(re.findall(r"`([\w./-]+(?:/|\.(?:py|lp|toml|json|txt)))`", page))
    assert len(named) > 50
    for file in named:
        places = [*near, package, *rooms]
        assert "NAME" in file or any((place / file).exists() for place in places), file
    assert rooms
    assert {f"{room.name}/" for room in rooms} <= set(re.findall(r"\b\w+/", page))


def test_the_page_for_newcomers_names_what_is_in_the_files():
    """Functions, classes and constants that it names together with their file."""
    page = re.sub(r"\s+", " ", (DOCS / "DEVELOPMENT.md").read_text())
    before = re.findall(r"`(\w+)`,? (?:\(|in )`([\w/]+\.py)`", page)
    after = [pair[::-1] for pair in re.findall(r"`([\w/]+\.py)` \(`(\w+)`", page)]
    assert len(before + after) > 20
    for name, file in before + after:
        texts = [
            path.read_text()
            for top in ("", "scripts/topomap")
            if (path := ROOT / top / file).is_file()
        ]
        assert any(
            re.search(rf"^(?:def|class) {name}\b|^{name}\b.* = ", text, re.MULTILINE)
            for text in texts
        ), (name, file)


# The name topomap on PyPI is another project's. So what is installed here is a path: a folder,
# or the file of a wheel.
INSTALL = re.compile(r"\bpip3? install\s+(?:--?[\w-]+(?:=\S+)?\s+)*([^\s`-][^\s`]*)")
PATH = re.compile(r"""['"]?(\.{0,2}/|\.(?=[\['"\s`]|$)|git\+https:|\S+\.whl)""")


def strangers(text):
    """What a text would have pip install by a name."""
    return [what for what in INSTALL.findall(text) if not PATH.match(what)]


def test_pip_installs_no_name():
    places = [README, ROOT / "Makefile", ROOT / "pyproject.toml", ROOT / "CITATION.cff"]
    for folder in ("docs", "scripts", "encodings", "instances", ".ci", ".github"):
        places += [path for path in (ROOT / folder).rglob("*") if path.is_file()]
    told = 0
    for path in places:
        if path.suffix in (".pyc", ".svg", ".json") or "egg-info" in str(path):
            continue
        text = path.read_text()
        told += len(INSTALL.findall(text))
        assert not strangers(text), str(path)
    assert told > 3


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("pip install topomap", ["topomap"]),
        ("pip install 'topomap[dask]'", ["'topomap[dask]'"]),
        ("python -m pip install --quiet -U topomap-asp", ["topomap-asp"]),
        ("a line that\nends in pip install\n  clingo.", ["clingo."]),
        ("without pip install -e, it", []),
        ("`pip install .`", []),
        ("pip install -e '.[dev]'", []),
        ("pip install '.[draw]' in the folder", []),
        ("pip install ./dist/topomap_asp-0.2.0-py3-none-any.whl", []),
        ("pip install dist/*.whl", []),
        ("pip install 'topomap_asp-0.2.0-py3-none-any.whl[dask]'", []),
        ("pip install git+https://example.org/topomap.git", []),
        ("pip install .venv", [".venv"]),
    ],
)
def test_names_that_pip_would_look_up(text, found):
    assert strangers(text) == found


def evidence():
    return (DOCS / "evidence.md").read_text()


def test_the_pages_show_the_committed_reports():
    text = evidence()
    beyond = json.loads((ROOT / "docs/beyond.json").read_text())["rows"]
    assert f"```text\n{figure4.table_text(beyond)}\n```" in text
    alone = [row["environment"] for row in beyond if not row["clingo"]]
    assert alone == ["4x5", "5x4", "5x5"]  # the first two are counted by merging
    assert not any(map(figure4.differences, beyond))
    report = (ROOT / "docs/mutation.md").read_text()
    (total,) = re.findall(r"^\| all \|(.*)\|$", report, re.M)
    ((most, asked),) = re.findall(r"at most ([\d,]+) of the\s+([\d,]+) queries", report)
    figures = [int(number) for number in re.findall(r"\d+", total)]
    mutants, survived, *_, larger, untried, equivalent = figures[4:]
    tried = f"{mutants - untried:,} of {mutants:,} mutants"
    tried += f", each asked at most {most} of {asked} queries"
    assert f"| {tried} | {survived} survive without a proof; " in text
    assert f"; {equivalent} equivalent, each with its reason; {larger} only ground to" in text


def test_the_pages_say_how_often_what_was_tried():
    """As the last whole run of the tests that was committed has it (make test-long)."""
    run = json.loads((ROOT / "docs/tried.json").read_text())
    number = {what: f"{times:,}" for what, times in run["tried"].items()}
    queries = number["queries on which ways to an answer were compared"]
    kinds = "files", "routes", "command lines"
    bad = ", ".join(f"{number[f'bad {kind} refused']} {kind}" for kind in kinds)
    asked = sum(n for what, n in run["tried"].items() if what.startswith("statements asked"))
    explained = number["explanations held against all assignments"]
    wrong = number["maps with errors judged by both checkers"]
    rows = [
        f"{number['random experiences']} random experiences, {queries} queries",
        f"{number['maps judged by both checkers']} maps; {wrong} with errors",
        bad,
        f"{number['strikes']} strikes",
        f"{number['cuts of long runs, resumed']} cuts",
        f"{asked:,} statements, {explained} explanations, "
        f"{number['plans against all walks']} plans, {number['statuses of a follower']} steps, "
        f"{number['experiences with misreadings']} experiences",
    ]
    assert (run["failed"], run["error"]) == (0, 0)
    for row in rows:
        assert f"| {row} |" in evidence()


def test_the_pages_say_how_much_memory_was_taken():
    maps, tenths = re.search(
        r"solve --output` of (\S+) maps .*: ([\d, ]+)\.", (ROOT / "docs/benchmark.md").read_text()
    ).groups()
    most = max(map(int, tenths.split(", ")))
    assert f"| {maps} maps | {most} MB throughout | `make bench`," in evidence()
