"""What is installed from the wheel does all that the checkout does, from any folder."""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import venv
import zipfile
from importlib.metadata import version

import pytest
import topomap
from conftest import ROOT
from topomap.cli import SUBCOMMANDS

SNAKE = "{instances}/grid-3x3-snake.lp"
CALLS = {  # of each subcommand, in this order, as some read what an earlier one wrote
    "path": ["path", "instances"],
    "clingo": ["clingo", "{encodings}/topomap.lp", SNAKE, "0", "-q"],
    "generate": ["generate", "grid", "2", "3", "--route", "snake", "-o", "grid.lp"],
    "log": ["log", "{log}", "-o", "log.lp"],
    "validate": ["validate", SNAKE, "grid.lp", "log.lp"],
    "solve": ["solve", SNAKE, "--optimal", "--planar", "--json", "-o", "maps.json"],
    "ask": ["ask", SNAKE, "same(1,7)"],
    "explain": ["explain", SNAKE, "same(1,7)"],
    "explore": ["explore", SNAKE],
    "follow": ["follow", SNAKE, "--no-wait"],
    "simulate": ["simulate", "grid", "1", "3"],
    "atlas": ["atlas", "{instances}/atlas.txt", "--timeout", "0.5", "-o", "atlas.md"],
    "count": ["count", SNAKE],
    "search": ["search", SNAKE, "--order", "best"],
    "branching": ["branching", SNAKE],
    "check": ["check", SNAKE, "maps.json"],
    "table": ["table", "--timeout", "0.5"],
    "family": ["family", "{instances}/batch.txt", "-d", "batch"],
    "draw": ["draw", "maps.json", "-o", "map.svg"],
    "show": ["show", SNAKE, "--planar"],
    "report": ["report", SNAKE, "--horizon", "6", "-o", "report.html"],
    "figures": ["figures", "figure3", "-d", "figures"],
    "export": ["export", "maps.json", "--format", "graphml", "-o", "map.graphml"],
    "import": ["import", "map.graphml"],
}
LOG = ROOT / "tests/files/courtyard.csv"
STATUS = {"clingo": 30, "explore": 1, "atlas": 3, "table": 3}
DRAWN = {"draw", "show", "report", "figures", "export"}  # by the extra


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The sdist, and the wheel that is made of it."""
    folder = tmp_path_factory.mktemp("dist")
    call = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT]
    subprocess.run(call, check=True, capture_output=True)
    (sdist,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    return sdist, wheel


def environment(folder, wheel=None):
    """A new environment, in which the wheel is installed, and packages are lent from this one;
    without a wheel it has pip and nothing else. Returns its folder of programs."""
    venv.create(folder, with_pip=wheel is None, symlinks=True)
    programs = folder / "bin"
    if wheel:
        install = [sys.executable, "-m", "pip", "--python", programs / "python", "install"]
        subprocess.run([*install, "--no-deps", "--no-index", "--quiet", wheel], check=True)
        (site,) = folder.glob("lib/python*/site-packages")
        # What such a file says of this folder is not read, so it does not lead to the checkout.
        (site / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return programs


def run(programs, folder, *words):
    """Run a program of an environment in a folder, with nothing else on the path."""
    known = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    return subprocess.run(
        [programs / words[0], *map(str, words[1:])],
        cwd=folder,
        env={**known, "PATH": f"{programs}:/usr/bin:/bin"},
        capture_output=True,
        text=True,
    )


def every_subcommand(programs, folder):
    """Call each from an empty folder; the files that it has then."""
    folder.mkdir()
    place = json.loads(run(programs, folder, "topomap", "path", "--json").stdout)
    for name, call in CALLS.items():
        done = run(programs, folder, "topomap", *(word.format(**place, log=LOG) for word in call))
        assert done.returncode == STATUS.get(name, 0), (name, done.stderr)
        assert "Traceback" not in done.stderr, name
    return {path.name for path in folder.iterdir()}


def test_each_subcommand_is_called():
    assert set(CALLS) == set(SUBCOMMANDS)


@pytest.mark.slow
def test_the_wheel_does_all_from_an_empty_folder(built, tmp_path):
    _, wheel = built
    programs = environment(tmp_path / "environment", wheel)
    told = "import sys, topomap; print(topomap, *sys.path)"
    origin = run(programs, tmp_path, "python", "-c", told)
    assert str(tmp_path) in origin.stdout
    assert str(ROOT) + "/scripts" not in origin.stdout
    made = every_subcommand(programs, tmp_path / "empty")
    assert {"map.svg", "report.html", "map.graphml", "batch"} <= made


def test_the_wheel_has_the_rules_and_no_clingo(built):
    sdist, wheel = built
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        (entry,) = [name for name in names if name.endswith("entry_points.txt")]
        assert archive.read(entry).decode().split("\n")[:2] == [
            "[console_scripts]",
            "topomap = topomap.__main__:run",
        ]
        assert archive.read(entry).decode().count("=") == 1
        (metadata,) = [name for name in names if name.endswith("METADATA")]
        assert "\nName: topomap-asp\n" in archive.read(metadata).decode()
    for folder in ("encodings", "instances"):
        ours = {
            f"topomap/{path.relative_to(ROOT)}"
            for path in (ROOT / folder).rglob("*")
            if path.is_file()
        }
        assert ours == {name for name in names if name.startswith(f"topomap/{folder}/")}
    assert "topomap/py.typed" in names
    with tarfile.open(sdist) as archive:
        tops = {name.split("/")[1] for name in archive.getnames() if "/" in name}
    assert {"encodings", "instances", "scripts", "tests", "docs", "Makefile", "README.md"} <= tops


def test_the_version_is_one():
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.M)[1]
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGES.md").read_text(), re.M)[1]
    assert cited == newest == topomap.__version__ == version("topomap-asp")


def test_clingo_keeps_its_exit_statuses(inside):
    rules, snake = ROOT / "encodings/topomap.lp", ROOT / "instances/grid-3x3-snake.lp"
    for arguments, status in (
        ([rules, snake, "1", "-q"], 10),
        ([rules, snake, "0", "-q"], 30),
        ([rules, ROOT / "encodings/bound.lp", snake, "-c", "places=2", "-q"], 20),
        (["no such file"], 65),
        (["--help"], 0),
    ):
        assert inside("clingo", *arguments).returncode == status, arguments


def megabytes(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 10**6


@pytest.mark.long
def test_from_nothing(built, tmp_path):
    """The base solves, counts and has the table; the extra draws."""
    _, wheel = built
    programs = environment(tmp_path / "environment")
    empty = megabytes(tmp_path / "environment")
    pip = "python", "-m", "pip", "install", "--quiet"
    assert run(programs, tmp_path, *pip, wheel).returncode == 0
    assert megabytes(tmp_path / "environment") - empty < 100
    assert not (programs / "clingo").exists()
    folder = tmp_path / "base"
    folder.mkdir()
    place = json.loads(run(programs, folder, "topomap", "path", "--json").stdout)
    for name, call in CALLS.items():
        done = run(programs, folder, "topomap", *(word.format(**place, log=LOG) for word in call))
        if name in DRAWN:
            assert (done.returncode, done.stderr.count("\n")) == (2, 1), name
            assert "pip install '.[draw]'" in done.stderr, name
        elif name != "import":  # it reads what export would have written
            assert done.returncode == STATUS.get(name, 0), (name, done.stderr)
    table = run(programs, folder, "topomap", "table")
    assert (table.returncode, table.stdout.splitlines()[-1]) == (0, "Every figure is the paper's.")
    assert run(programs, tmp_path, *pip, f"{wheel}[draw]").returncode == 0
    every_subcommand(programs, tmp_path / "all")


@pytest.mark.long
@pytest.mark.timeout(1500)  # it installs all that the tests need, and runs some of them
def test_the_sdist_makes_itself_and_runs_its_tests(built, tmp_path):
    """In a folder with a blank and letters that are not ASCII in its name."""
    sdist, _ = built
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    folder = tmp_path / "a b ü"
    next(tmp_path.glob("topomap_asp-*")).rename(folder)
    known = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    call = {"cwd": folder, "env": known, "capture_output": True, "text": True}
    done = subprocess.run(["make", "-j4"], **call)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "Every figure is the paper's."
    assert (folder / ".venv/bin/clingo").exists()
    subprocess.run(["make", ".venv/tools"], **call, check=True)
    chosen = "commands/test_cli", "theory/test_input", "theory/test_rules"
    files = [f"tests/{name}.py" for name in chosen]
    done = subprocess.run([".venv/bin/pytest", "-m", "not slow and not long", *files], **call)
    assert done.returncode == 0, done.stdout[-3000:]


@pytest.fixture
def checkout(tmp_path):
    """The parts of the repository that `make instances` needs, without an environment."""
    folder = tmp_path / "checkout"
    folder.mkdir()
    for name in ("Makefile", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy2(ROOT / name, folder)
    for name in ("encodings", "scripts"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "instances").mkdir()
    (folder / "instances/batch.txt").write_text("grid 2 2 --route snake\n")
    return folder


@pytest.mark.long
def test_make_makes_its_environment_anew(checkout, tmp_path):
    """After the folder was moved, and with another Python."""

    def make(folder, *words):
        call = ["make", *words, "instances"]
        known = {key: value for key, value in os.environ.items() if key != "PYTHON"}
        return subprocess.run(call, cwd=folder, env=known, capture_output=True, text=True)

    first = make(checkout)
    assert first.returncode == 0, first.stderr
    assert "-m venv" in first.stdout
    assert "-m venv" not in make(checkout).stdout
    moved = checkout.rename(tmp_path / "moved")
    done = make(moved)
    assert (done.returncode, "-m venv" in done.stdout) == (0, True), done.stderr
    other = tmp_path / "python-of-another-version"
    real = shutil.which("python3")
    other.write_text(
        f'#!/bin/sh\ncase "$2" in *base_prefix*) echo /other 3.99.0;; *) exec {real} "$@";; esac\n'
    )
    other.chmod(0o755)
    assert "-m venv" in make(moved, f"PYTHON={other}").stdout


NETWORK = """\
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="x" for="node" attr.name="x" attr.type="double"/>
<key id="y" for="node" attr.name="y" attr.type="double"/>
<graph edgedefault="undirected">
<node id="a"><data key="x">0</data><data key="y">0</data></node>
<node id="b"><data key="x">9</data><data key="y">0</data></node>
<node id="c"><data key="x">9</data><data key="y">9</data></node>
<edge source="a" target="b"/>
<edge source="b" target="c"/>
</graph></graphml>
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["plain.graphml", 'a street\'s $HOME `x` "%" ü.graphml'])
def test_instances_are_made_again_when_their_network_changes(checkout, name):
    (checkout / ".venv").symlink_to(ROOT / ".venv")
    if not (ROOT / ".venv/set-up").exists():
        pytest.skip("make has not set up .venv")
    network = checkout / name
    network.write_text(NETWORK)
    quoted = "'" + name.replace("'", "'\"'\"'") + "'"
    family = checkout / "instances/batch.txt"
    family.write_text(f"network {quoted} --route tour --name street\ngrid 2 2 --route snake\n")

    def make():
        """The instance's text, and when each was written."""
        call = ["make", "-j2", "-o", ".venv/set-up", "instances"]
        done = subprocess.run(call, cwd=checkout, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        made = sorted((checkout / "build/instances").glob("*.lp"))
        return (made[1].read_text(), *(path.stat().st_mtime_ns for path in made))

    text, grid, street = make()
    assert "turn(4," in text
    assert make() == (text, grid, street)
    network.touch()
    assert make()[:2] == (text, grid)
    assert make()[2] > street
    network.write_text(NETWORK.replace('<edge source="b" target="c"/>\n', ""))
    assert "turn(3," not in make()[0]
    network.unlink()
    call = ["make", "-o", ".venv/set-up", "instances"]
    done = subprocess.run(call, cwd=checkout, capture_output=True, text=True)
    assert done.returncode == 2
    assert "batch.txt:1" in done.stderr
