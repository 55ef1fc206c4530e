"""Scripts that use topomap: they end well, with their own exit status, and nothing of them is
done twice."""

import subprocess
import sys

import pytest
from conftest import ROOT

SNAKE = ROOT / "instances/grid-3x3-snake.lp"
LARGER = ROOT / "instances/grid-4x4-snake.lp"
LARGE = ROOT / "instances/manhattan-tour88-signs30.lp"
READ = f"import sys, topomap\nseen = topomap.read({str(LARGER)!r})\n"


def script(text, *arguments, **options):
    """Run a script in a Python of its own."""
    call = [sys.executable, *(arguments or ("-c", text))]
    return subprocess.run(call, capture_output=True, text=True, timeout=120, **options)


ENDS = {
    "limit": "answer = topomap.solve(seen, limit=5)\nprint(len(answer))",
    "break": "for one in topomap.solve(seen):\n    print(5)\n    break",
    "break, and the answer is kept": "answer = topomap.solve(seen)\n"
    "for one in answer:\n    print(5)\n    break",
    "the first one": "answer = topomap.solve(seen)\nprint(answer[0] and 5)",
    "many wait": "answers = [topomap.solve(seen) for _ in range(5)]\n"
    "print(len([answer[0] for answer in answers]))",
    "while it solves": f"seen = topomap.read({str(LARGE)!r})\n"
    "answer = topomap.solve(seen, optimal=True, timeout=0.5)\nprint(5, answer.fault)",
    "while it grounds": "seen = topomap.generate('grid', 12, 12, route='snake').experience\n"
    "answer = topomap.solve(seen, planar=True, perpendicular=True, timeout=0.1)\n"
    "print(5, answer.fault)",
    "in a thread": "import threading\n"
    "threading.Thread(target=lambda: len(topomap.solve(seen)), daemon=True).start()\nprint(5)",
    "by processes": "answer = topomap.solve(seen, jobs=2)\nprint(answer[0] and 5)",
}


@pytest.mark.slow
@pytest.mark.parametrize("how", ENDS)
@pytest.mark.parametrize(("end", "status"), [("", 0), ("sys.exit(3)", 3), ("1 / 0", 1)])
def test_a_script_ends_with_its_own_status(how, end, status):
    """While clingo is still working, in threads that are no longer waited for."""
    done = script(f"{READ}{ENDS[how]}\n{end}")
    assert (done.returncode, done.stdout.split()[0]) == (status, "5"), done.stderr
    assert [line for line in done.stderr.splitlines() if not line.startswith("  ")] == (
        []
        if status != 1
        else ["Traceback (most recent call last):", "ZeroDivisionError: division by zero"]
    )


def test_what_c_has_yet_to_write_is_written_where_a_thread_still_grounds(tmp_path):
    done = script(
        f"{READ}{ENDS['while it grounds']}\n"
        "import ctypes\nctypes.CDLL(None).printf(b'written by C')",
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "written by C" in done.stdout


def test_after_the_end_nothing_is_begun():
    """A request while the process ends is answered as interrupted."""
    done = script(
        "import atexit\n"
        "def late():\n    print(answer.fault)\n"
        "atexit.register(late)\n"
        f"{READ}answer = topomap.solve(seen)\nanswer[0]\nimport topomap.solver.threads"
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "interrupted\n", "")


COUNTED = f"""
import topomap
print("begun")
print(len(topomap.solve(topomap.read({str(SNAKE)!r}), jobs=2)))
"""


@pytest.mark.parametrize("way", ["a file", "standard input", "an argument"])
def test_workers_do_not_run_the_script_again(way, tmp_path):
    """A script needs no ``if __name__ == "__main__"``."""
    file = tmp_path / "counted.py"
    file.write_text(COUNTED)
    if way == "standard input":
        done = script("", "-", input=COUNTED)
    else:
        done = script(COUNTED, *([file] if way == "a file" else []))
    assert (done.returncode, done.stdout, done.stderr) == (0, "begun\n88\n", "")


def test_workers_find_modules_where_the_script_does(tmp_path):
    """Also those that only it knows of, and in no other place: not in the folder it is run in."""
    package = ROOT / "scripts"
    (tmp_path / "queue.py").write_text("raise ImportError('of the folder')")
    lines = f"import sys\nsys.path.insert(0, {str(package)!r})\n{COUNTED}"
    done = script(lines, "-P", "-c", lines, cwd=tmp_path, env={})
    assert (done.returncode, done.stdout, done.stderr) == (0, "begun\n88\n", "")
