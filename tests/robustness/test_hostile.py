"""Hostile input, by name: each is refused in one clear line, soon, and in little memory. And
outputs that cannot be written."""

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from conftest import BIN, ROOT

GRID = ROOT / "instances/grid-3x3-snake.lp"
HEAD = "slots(4). view(0,0). "
DEEP = "f(" * 100_000 + "0" + ")" * 100_000
INSTANCES = {
    "script": (HEAD + '#script (python)\nimport os; os.mkdir("made")\n#end.', "not a ground fact"),
    "script alone": ('#script (lua) os.execute("mkdir made") #end.', "not a ground fact"),
    "include": ('#include "/etc/passwd".', "not a ground fact"),
    "include of a part": (HEAD + "#include <incmode>.", "not a ground fact"),
    "external function": (HEAD + "view(0,@os()).", "not a ground fact"),
    "deep term": (f"{HEAD} landmark(0,{DEEP}).", "nested deeper than 100"),
    "deep tuple": (f"{HEAD} landmark(0,{'(' * 100_000}0{')' * 100_000}).", "nested deeper"),
    "deep bars": (f"{HEAD} landmark(0,{'|-' * 100_000}0{'|' * 100_000}).", "nested deeper"),
    "deep brackets that never end": (f"{HEAD} landmark(0,{'f(' * 100_000}.", "not a ground fact"),
    "deep comment": ("%* " * 100_000, "a comment does not end"),
    "many signs": (f"{HEAD} view(0,{'-' * 100_001}1).", "not a plain fact"),
    "many slots": ("slots(1000000000). view(0,0).", "slots(1000000000): K must be"),
    "step -1": (HEAD + "turn(-1,0).", "step -1: steps are numbered from 0"),
    "step 0": (HEAD + "turn(0,0).", "step 0: there is a turn"),
    "step 10^9": (HEAD + "turn(1000000000,0). view(1000000000,0).", "step 1: no turn"),
    "overflow of slots": ("slots(99999999999). view(0,0).", "not a plain fact"),
    "overflow to a good one": ("slots(4294967300). view(0,0).", "not a plain fact"),
    "overflow of a step": (HEAD + "view(4294967296,0).", "not a plain fact"),
    "Cyrillic letter": ("sl\u043ets(4). view(0,0).", "not a ground fact"),
    "full-width digit": ("slots(\uff14). view(0,0).", "not a ground fact"),
    "Arabic digit": (HEAD + "view(0,\u0661).", "not a ground fact"),
    "full-width stop": ("slots(4)\uff0e view(0,0)\uff0e", "does not end"),
    "no-break space": ("slots(4).\u00a0view(0,0)\u00a0.view(0,1\u00a0).", "not a ground fact"),
    "NUL": (HEAD + "\0", "not a text file"),
    "NUL in a comment": (HEAD + "% \0", "not a text file"),
    "carriage return in a comment": ("slots(4). % no fact:\rview(0,0).", "step 0: no view"),
    "Latin-1": (HEAD.encode() + b"% \xe4", "not a text file"),
    "UTF-16": (HEAD.encode("utf-16"), "not a text file"),
    "long name": (HEAD + "a" * 1_000_000 + "(0).", "is not a fact over"),
    "many arguments": (f"{HEAD} view({'0,' * 1_000_000}0).", "view has 2 arguments, view(T,S)"),
    "open string": (HEAD + 'landmark(0,"' + "a" * 1_000_000, "does not end"),
    "many quotes": (HEAD + '"' * 1_000_001 + ".", ""),
}
LAUGHS = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 12))
NODES = '<node id="a"/><node id="b"/><edge source="a" target="b"/>'
NETWORKS = {
    "billion laughs": f'<!DOCTYPE a [<!ENTITY a0 "ha">{LAUGHS}]><graphml>&a11;</graphml>',
    "one large entity": f'<!DOCTYPE a [<!ENTITY b "{"x" * 100_000}">]><a>{"&b;" * 100_000}</a>',
    "external entity": '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]><graphml>&b;</graphml>',
    "parameter entity": '<!DOCTYPE a [<!ENTITY % b SYSTEM "file:///etc/passwd"> %b;]><graphml/>',
    "external subset": '<!DOCTYPE a SYSTEM "http://127.0.0.1:9/a.dtd"><graphml/>',
}


WORKER = """
import contextlib, io, json, os, sys
from topomap.cli import main
for line in sys.stdin:
    folder, call = json.loads(line)
    os.chdir(folder)
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main(call)
    print(json.dumps([status, out.getvalue(), err.getvalue()]), flush=True)
"""
workers = []


def limited():
    """The memory within which hostile input is to be refused: 2 GiB."""
    resource.setrlimit(resource.RLIMIT_AS, (2 * 2**30,) * 2)


def refusal(folder, *arguments):
    """The one line in which a command refuses, with status 2."""
    status, out, err = called(folder, *arguments)
    assert (status, out) == (2, ""), err[-500:]
    assert err.count("\n") == 1
    assert len(err) < 1000
    return err


def called(folder, *arguments):
    """The status and the output of a command that ends soon. One process takes the calls in
    turn; a new one, after one that it did not survive."""
    if not workers or workers[-1].poll() is not None:
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        workers.append(
            subprocess.Popen([sys.executable, "-c", WORKER], preexec_fn=limited, **pipes)
        )
    begun = time.monotonic()
    workers[-1].stdin.write(json.dumps([str(folder), [str(word) for word in arguments]]) + "\n")
    workers[-1].stdin.flush()
    answer = workers[-1].stdout.readline()
    assert answer, f"it died: status {workers[-1].wait()}"
    assert time.monotonic() - begun < 10
    assert not (folder / "made").exists()
    return json.loads(answer)


@pytest.fixture(scope="module", autouse=True)
def workers_end():
    yield
    for worker in workers:
        worker.stdin.close()
        assert worker.wait() == 0


@pytest.mark.parametrize("name", INSTANCES)
def test_hostile_instances(tmp_path, name):
    content, fault = INSTANCES[name]
    file = tmp_path / "bad.lp"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    line = refusal(tmp_path, "solve", file)
    assert line.startswith(f"{file}:")
    assert fault in line
    status, out, err = called(tmp_path, "validate", file)
    assert (status, err) == (2, "")
    first, *rest = out.splitlines(keepends=True)
    assert first == line
    assert all(fault.startswith(f"{file}:") and len(fault) < 1000 for fault in rest)
    assert len(rest) <= 1000


def test_large_instances_with_many_faults(tmp_path):
    """They are cut short, and what is good but large is judged within the same time."""
    file = tmp_path / "bad.lp"
    for piece, lines in (("view(0,{}).", 52), ("veiw({},0).", 52), ("turn({},9).", 52)):
        file.write_text("slots(4). view(0,0).\n" + "".join(map(piece.format, range(10, 10_000))))
        status, out, err = called(tmp_path, "validate", file)
        assert (status, err, out.count("\n")) == (2, "", lines)
    seen = "".join(f" view(0,{slot})." for slot in range(0, 20_000, 2))
    file.write_text(f"slots(1000000).{seen} turn(1,0). view(1,0).")
    status, out, err = called(tmp_path, "validate", file)
    assert (status, err) == (0, "")
    assert out.startswith(f"{file}: valid: 1 step, 1,000,000 slots, ")


@pytest.mark.parametrize("piece", ["view(0,0). ", '"'])
@pytest.mark.parametrize("command", [["solve"], ["generate", "network"], ["family", "-d", "made"]])
def test_a_line_of_100_megabytes(tmp_path, piece, command):
    file = tmp_path / "long"
    with file.open("w") as out:
        for _ in range(100):
            out.write(piece * (10**6 // len(piece) + 1))
    route = ["--route", "tour"] if "network" in command else []
    assert refusal(tmp_path, *command, file, *route) == f"{file}: larger than 32 MiB\n"


@pytest.mark.parametrize("file", ["/dev/zero", "/dev/null"])
@pytest.mark.parametrize("call", [["solve"], ["check", GRID], ["solve", GRID, "--truth"]])
def test_devices_as_input(tmp_path, file, call):
    assert refusal(tmp_path, *call, file).startswith(f"{file}: ")


def test_a_real_map_of_100_megabytes(tmp_path):
    file = tmp_path / "long"
    file.write_text('{"maps": [{"at": [' + ", ".join(["[0, 0, 0]"] * 10**7) + "]}]}")
    line = refusal(tmp_path, "solve", GRID, "--truth", file)
    assert line == f"{file}: larger than 32 MiB\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("name", NETWORKS)
def test_hostile_networks(tmp_path, name, encoding):
    file = tmp_path / "bad.graphml"
    declared = (
        "" if "sig" in encoding else f'<?xml version="1.0" encoding="{encoding[:6].rstrip("-")}"?>'
    )
    file.write_bytes((declared + NETWORKS[name]).encode(encoding))
    line = refusal(tmp_path, "generate", "network", file, "--route", "tour")
    assert line.startswith(f"{file}: ")
    # Without a byte order mark the parser takes UTF-16 for no XML.
    assert "document type or entities" in line or encoding[-3:] in ("-le", "-be")


def test_other_hostile_networks(tmp_path):
    file = tmp_path / "bad.graphml"
    for content, fault in (
        ("<graphml>" + "<graph>" * 200_000, "not a GraphML file"),
        ("<a>" * 200_000 + "</a>" * 200_000, "not in one of the formats"),
        (f"<graphml><graph>{NODES}</graph></graphml>", "place a has no coordinates"),
        (f"<graphml><graph>{NODES}</graph></graphml>".replace('"a"', '"&#10;"'), r"place \n has"),
        ("\0" * 1000, "not in one of the formats"),
        ("<graphml>" + "\0" * 1000, "not a GraphML file"),
    ):
        file.write_text(content)
        line = refusal(tmp_path, "generate", "network", file, "--route", "tour")
        assert line.startswith(f"{file}: ")
        assert fault in line


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        ("[" * 200_000, "not a JSON"),
        ('{"maps": [{"at": ' + "[" * 200_000 + "]" * 200_000 + "}]}", "not a JSON"),
        ('{"maps": [{"at": [[0, 1e999, 0]]}]}', "map 1: at is not"),
        ('{"maps": [{"at": [[0, true, 0]]}]}', "map 1: at is not"),
        ('{"maps": [{"at": [["0", "0", "0"]]}]}', "map 1: at is not"),
        ('{"maps": [{"at": [[0, ' + "9" * 5000 + ", 0]]}]}", "not a JSON"),
        ('{"maps": [{"at": [[0, 0, 0]]}]} \0', "not a text"),
        ('{"maps": [{"at": [[0, 0, 0]]}]}', "0 steps, but the instance has 16"),
        (
            f'{{"maps": [{{"at": {[[t, 0, 0] for t in range(17)]}}}]}}',
            "step 1: it breaks the rule itself",
        ),
        (f'{{"maps": [{{"at": {[[t, 10**30, 0] for t in range(17)]}}}]}}', "map 1: at is not"),
        (f'{{"maps": [{{"at": {[[t, 99, 0] for t in range(17)]}}}]}}', "step 0: it breaks"),
    ],
)
def test_hostile_truths(tmp_path, content, fault):
    file = tmp_path / "bad.json"
    file.write_text(content)
    line = refusal(tmp_path, "solve", GRID, "--truth", file)
    assert line.startswith(f"{file}: ")
    assert fault in line


@pytest.mark.parametrize(
    "arguments",
    [
        "grid 2147483647 2147483647 --route snake",
        "triangles 100000 2 --route tour",
        "grid 3 3 --route walk --steps 1000000000",
        "grid 3 3 --route walk --steps 99999999999999999999",
        f"grid 3 3 --route {'1' * 5000}",
        "grid 3 3 --route \uff10",
        "grid \uff13 3 --route snake",
        "network NET --route tour --north 1e308",
        "network NET --route tour --slots 2147483646",
        "grid 3 3 --route E --name ../up",
        f"grid 3 3 --route E --name {'a' * 300} -o ./",
    ],
)
def test_hostile_worlds(tmp_path, arguments):
    assert refusal(tmp_path, "generate", *arguments.split()).strip()


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("grid {1..999999999} 3 --route snake", ":1: more than 100000"),
        ("grid " + "{1,2}" * 40 + " 3 --route snake", ":1: more than 100000"),
        ("grid 3 3 --help", ":1: --help cannot be used"),
        ("grid 3 3 --route E -o /etc/none", ":1: -o, --truth and --json"),
        ("\ngrid 3 3 --route 'E", ":2: no closing quotation"),
        ("grid 3 3 --route E\0", ": not a text file"),
    ],
)
def test_hostile_families(tmp_path, line, fault):
    file = tmp_path / "family.txt"
    file.write_text(line)
    assert refusal(tmp_path, "family", file, "-d", "made").startswith(f"{file}{fault}")


def test_a_list_of_a_family_names_nothing_outside_its_folder(tmp_path):
    folder = tmp_path / "family"
    folder.mkdir()
    (tmp_path / "mine.lp").write_text("mine")
    (tmp_path / "family.txt").write_text("grid 2 2 --route E\n")
    (folder / ".family").write_text(f"../mine\n{tmp_path}/mine\n")
    call = [BIN / "topomap", "family", tmp_path / "family.txt", "-d", folder]
    assert subprocess.run(call, stdout=subprocess.DEVNULL).returncode == 0
    assert (tmp_path / "mine.lp").read_text() == "mine"
    (folder / ".family").unlink()
    (folder / ".family").mkdir()
    assert "is a directory" in refusal(tmp_path, *call[1:])


# Outputs


def topomap(*arguments, shell="", **options):
    """A command, its streams redirected as in the shell."""
    call = ["bash", "-c", f'"$0" "$@" {shell}', BIN / "topomap", *map(str, arguments)]
    return subprocess.run(call, capture_output=True, text=True, **options)


def test_a_link_as_output_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there/file", tmp_path / "link"
    link.symlink_to("there/file")
    for before in (None, "old"):
        target.unlink(missing_ok=True)
        if before:
            target.write_text(before)
        assert topomap("solve", GRID, "--limit", "1", "-o", link).returncode == 3
        assert link.is_symlink()
        assert target.read_text().startswith("map 1: ")
    loop = tmp_path / "loop"
    loop.symlink_to("loop")
    assert "symbolic links" in refusal(tmp_path, "solve", GRID, "-o", loop)
    assert loop.is_symlink()
    assert {path.name for path in tmp_path.iterdir()} == {"there", "link", "loop"}


COMMANDS = [
    ["solve", GRID, "--limit", "3"],
    ["solve", GRID, "--limit", "3", "--json"],
    ["count", GRID, "--horizon", "9"],
    ["generate", "grid", "3", "3", "--route", "snake"],
    ["generate", "grid", "3", "3", "--route", "snake", "--json"],
    ["--help"],
    ["solve", "--help"],
    ["--version"],
]


@pytest.mark.parametrize(
    "command",
    [
        *(COMMANDS[0], COMMANDS[4], COMMANDS[5]),
        *(pytest.param(command, marks=pytest.mark.long) for command in COMMANDS),
    ],
    ids=lambda command: " ".join(map(str, command[:2])),
)
@pytest.mark.parametrize(
    ("shell", "fault"), [(">/dev/full", "no space left on device"), (">&-", "bad file descriptor")]
)
def test_standard_output_that_cannot_be_written(command, shell, fault):
    done = topomap(*command, shell=shell)
    assert (done.returncode, done.stderr) == (2, f"standard output: {fault}\n")


def test_nothing_is_written_beside_a_standard_output_that_cannot_be(tmp_path):
    truth = tmp_path / "truth.json"
    done = topomap(*COMMANDS[3], "--truth", truth, shell=">/dev/full")
    assert done.returncode == 2
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("shell", ["2>&-", "2>/dev/full", "2>&- <&-"])
def test_standard_error_that_cannot_be_written(shell):
    done = topomap(*COMMANDS[0], shell=shell)
    assert (done.returncode, done.stdout.count("map")) == (3, 4)
    assert topomap("solve", "none.lp", shell=shell).returncode == 2
    assert topomap("solve", "none.lp", shell=f"{shell} >&-").stdout == ""


@pytest.mark.long
def test_progress_that_cannot_be_written():
    large = ROOT / "instances/manhattan-tour40-signs30.lp"
    done = topomap("solve", large, "--timeout", "4", shell="2>/dev/full | tail -1")
    assert done.stdout.endswith("partial: timeout\n")


def test_a_pipe_that_breaks_is_quiet():
    for command in COMMANDS[:5]:
        done = topomap(*command, shell="| true; exit ${PIPESTATUS[0]}")
        assert (done.returncode in (0, 3), done.stderr) == (True, "")
    done = topomap("solve", "none.lp", shell="2> >(true)")
    assert done.returncode == 2


OUTPUTS = [[*command, "-o"] for command in COMMANDS[:4]] + [
    [*COMMANDS[3], "-o", "/dev/null", "--truth"]
]


@pytest.mark.parametrize("command", OUTPUTS, ids=lambda command: command[0] + command[-1])
def test_full_devices(tmp_path, command):
    assert refusal(tmp_path, *command, "/dev/full") == "/dev/full: no space left on device\n"
    assert refusal(tmp_path, *command, tmp_path / "no/file").endswith("no such file or directory\n")
    assert "directory" in refusal(tmp_path, *command, f"{tmp_path}/file/")
    if command[0] != "generate" or "--truth" in command:
        assert refusal(tmp_path, *command, tmp_path).endswith("is a directory\n")
    assert not any(tmp_path.iterdir())


def test_one_file_cannot_be_both(tmp_path):
    assert "both" in refusal(tmp_path, *COMMANDS[3], "-o", "a", "--truth", "./a")
    assert not any(tmp_path.iterdir())


def test_no_room_left(tmp_path):
    """On a file system of 64 KiB: what was there stays."""
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("no file system can be mounted here")
    try:
        file = folder / "maps.json"
        file.write_text("old")
        line = refusal(tmp_path, "solve", GRID, "--by", "clingo", "--json", "-o", file)
        assert line == f"{file}: no space left on device\n"
        assert file.read_text() == "old"
        assert {path.name for path in folder.iterdir()} == {file.name, f"{file.name}.part"}
        assert topomap("solve", GRID, "--closed", "--json", "-o", file).returncode == 0
    finally:
        subprocess.run(["umount", folder], check=True)


def test_a_folder_that_cannot_be_written():
    """As another user where the tests run as root, which may write everywhere."""
    program = """
import contextlib, io, os, sys
from topomap.cli import main
with contextlib.redirect_stdout(io.StringIO()):
    main(sys.argv[1:-2])  # so that all is loaded: the other user may not be allowed to read it
if os.geteuid() == 0:
    os.setgid(65534)
    os.setuid(65534)
sys.exit(main(sys.argv[1:]))
"""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "grid.lp"
        file.write_text("old")
        folder.chmod(0o555)
        call = [sys.executable, "-c", program, *COMMANDS[3], "-o", file]
        done = subprocess.run(call, capture_output=True, text=True)
        folder.chmod(0o755)
        assert (done.returncode, done.stderr) == (2, f"{file}: permission denied\n")
        assert [path.read_text() for path in folder.iterdir()] == ["old"]


def test_a_name_as_long_as_a_name_can_be(tmp_path):
    for name in ("a" * 255, "\u00e4" * 127):
        assert topomap(*COMMANDS[3], "-o", tmp_path / name).returncode == 0
    assert "too long" in refusal(tmp_path, *COMMANDS[3], "-o", tmp_path / ("a" * 256))


def test_names_that_are_no_text(tmp_path):
    name = os.fsdecode(b"\xff\n.lp")
    shutil.copy(GRID, tmp_path / name)
    done = topomap("solve", tmp_path / name, GRID, "--limit", "1")
    assert (done.returncode, done.stderr) == (3, "")
    assert (
        topomap("solve", tmp_path / name, "--json", "-o", tmp_path / f"{name}.json").returncode == 0
    )
    (tmp_path / name).write_text("slots(5).")
    assert r"\udcff\n.lp:1: slots(5)" in refusal(tmp_path, "solve", tmp_path / name)
