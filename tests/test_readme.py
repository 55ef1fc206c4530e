"""The README's commands run as written and print what it says; ``...`` stands for any text."""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from conftest import BIN, ROOT
from topomap import figure4

README = ROOT / "README.md"
BLOCKS = re.findall(r"^```console\n(.*?)^```", README.read_text(), re.M | re.S)
CALLS = [
    (call.partition("\n")[0], call.partition("\n")[2])
    for block in BLOCKS
    for call in re.split(r"^\$ ", block, flags=re.M)[1:]
    if not call.startswith("make")
]


def case(command, expected):
    """A command as a test; those that take seconds, and are tried elsewhere too, are long."""
    names = "tour88", "tour40", "topomap report", "topomap table"
    slow = any(name in command for name in names)
    return pytest.param(command, expected, id=command, marks=[pytest.mark.long] if slow else [])


@pytest.mark.parametrize(("command", "expected"), [case(*call) for call in CALLS])
def test_a_command_prints_what_the_readme_says(tmp_path, command, expected):
    for name in ("encodings", "instances"):
        Path(tmp_path / name).symlink_to(ROOT / name)
    done = subprocess.run(
        ["bash", "-c", command],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"},
    )
    pattern = ".*".join(re.escape(text.strip("\n")) for text in expected.split("..."))
    assert re.fullmatch(pattern, done.stdout.strip("\n"), re.DOTALL)


def test_the_readme_shows_the_committed_reports():
    text = README.read_text()
    beyond = json.loads((ROOT / "docs/beyond.json").read_text())["rows"]
    assert f"```text\n{figure4.text(beyond)}\n```" in text
    assert [row["environment"] for row in beyond if not row["clingo"]] == ["5x5"]
    assert not any(map(figure4.differences, beyond))
    (total,) = re.findall(r"^\| all \|(.*)\|$", (ROOT / "docs/mutation.md").read_text(), re.M)
    figures = [int(number) for number in re.findall(r"\d+", total)]
    mutants, survived, *_, larger, equivalent = figures[4:]
    assert f"| {mutants:,} mutants | {survived} survive; {equivalent} equivalent" in text
    assert f"; {larger} of `fast/` and `online/` only" in text


def test_the_readme_says_how_often_what_was_tried():
    """As the last whole run of the tests that was committed has it (make test-long)."""
    run = json.loads((ROOT / "docs/tried.json").read_text())
    number = {what: f"{times:,}" for what, times in run["tried"].items()}
    queries = number["queries on which ways to an answer were compared"]
    bad = " + ".join(number[f"bad {what} refused"] for what in ("files", "routes", "command lines"))
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
        assert f"| {row} |" in README.read_text()


def test_the_readme_says_how_much_memory_was_taken():
    maps, tenths = re.search(
        r"solve --output` of (\S+) maps .*: ([\d, ]+)\.", (ROOT / "docs/benchmark.md").read_text()
    ).groups()
    most = max(map(int, tenths.split(", ")))
    assert f"| {maps} maps | {most} MB throughout | `make bench`," in README.read_text()


def test_the_readme_has_commands():
    assert len(CALLS) > 10
