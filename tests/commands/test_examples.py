"""The examples of the helps, which the site shows on the page of each command: they are calls that
there are, and they do what they say."""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import BIN, ROOT, run
from topomap.cli import parse
from website import commands

SECONDS = 10  # then an example is interrupted: some wait for more lines, some take minutes
ENDS = {0, 1, 3, 130, 124}  # done; no; partial; interrupted, as reported by topomap or by timeout
OF_CLINGO = {10, 30}  # clingo found models, or found them all
TOOLS = {"neato", "less", "clingraph"}  # programs that need not be there
WALK = "slots(4).\nview(0,0).\nturn(1,0). view(1,0). view(1,2).\nturn(2,2). view(2,0).\n"


def parsers(parser):
    """A parser, and those of its own kinds."""
    yield parser
    for action in parser._actions:
        if isinstance(action, commands.Sub):
            yield from action.choices.values()


def examples(name):
    parser = commands.parser_of(name)
    return [call for one in parsers(parser) for call in commands.examples(one)]


@pytest.mark.parametrize("name", commands.names())
def test_the_examples_are_calls_that_there_are(name):
    calls = examples(name)
    assert any(re.search(rf"\btopomap {name}\b", call) for call in calls)
    for call in calls:
        for part in re.split(r" \| ", call):
            words = shlex.split(part)
            if words[0] == "topomap" and words[1] != "clingo":
                parse(words[1:])


@pytest.fixture
def folder(tmp_path):
    """A folder with the files that the examples name."""
    for part in ("encodings", "instances"):
        Path(tmp_path / part).symlink_to(ROOT / part)
    (tmp_path / "walk.lp").write_text(WALK)
    (tmp_path / "walk.csv").write_text("exits,taken\n0,0\n0 180,180\n0,\n")
    (tmp_path / "walk.jsonl").write_text('{"exits": ["N"], "taken": "N"}\n{"exits": ["S"]}\n')
    (tmp_path / "robot").write_text(f"#!/bin/sh\ncat <<'END'\n{WALK}END\n")
    (tmp_path / "robot").chmod(0o755)
    town = ["generate", "grid", "3", "3", "--route", "tour", "--world", tmp_path / "city.graphml"]
    assert run("topomap", *town).returncode == 0
    maps = ["solve", ROOT / "instances/grid-3x3-snake.lp", "--closed", "--json"]
    assert run("topomap", *maps, "-o", tmp_path / "maps.json").returncode == 0
    return tmp_path


@pytest.mark.long
@pytest.mark.parametrize("name", commands.names())
def test_the_examples_do_what_they_say(folder, name):
    """None of them is refused; those of one help are called one after the other."""
    path = os.pathsep.join([str(folder), str(BIN), os.environ["PATH"]])
    for call in examples(name):
        if any(tool in call and not shutil.which(tool, path=path) for tool in TOOLS):
            continue
        limit = ["timeout", "--signal=INT", f"--kill-after={SECONDS}", str(SECONDS)]
        done = subprocess.run(
            [*limit, "bash", "-o", "pipefail", "-c", f"trap : INT; {call}"],
            capture_output=True,
            text=True,
            cwd=folder,
            env={**os.environ, "PATH": path},
        )
        ends = ENDS | OF_CLINGO if "clingo" in call else ENDS
        if "veiw" in call:  # it shows how a fault is reported
            ends = {2}
            assert "did you mean view/2?" in done.stdout
        assert done.returncode in ends, (call, done.returncode, done.stderr)
        assert "Traceback" not in done.stderr
