"""The answer of ``topomap.solve``: it says no more than is known, begins when it is asked, and
ends when it is not wanted any more."""

import contextlib
import gc
import subprocess
import sys
import threading
import time
import weakref
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import topomap
from conftest import ROOT
from topomap.model.found import Found
from topomap.solver import threads

GRID = ROOT / "instances/grid-3x3-snake.lp"
LARGER = ROOT / "instances/grid-4x4-snake.lp"


@pytest.fixture(scope="module")
def seen():
    return topomap.read(GRID)


@pytest.fixture(scope="module")
def larger():
    return topomap.read(LARGER)


@pytest.fixture(scope="module")
def some(seen):
    """Six maps, as they are found."""
    return [one.found for one in topomap.solve(seen, limit=6)]


class Finder:
    """Stands in for the solver: it finds given things, and raises an error that is among them."""

    def __init__(self):
        self.found = []
        self.given = 0
        self.closed = False
        self.each = lambda watch: None  # called before each one

    def __call__(self, experience, query, watch, *_):
        try:
            for one in self.found:
                self.each(watch)
                if isinstance(one, BaseException):
                    raise one
                self.given += 1
                yield one
        finally:
            self.closed = True


@pytest.fixture
def finder(monkeypatch):
    made = Finder()
    monkeypatch.setattr("topomap.api.solve.every", made)
    return made


# What was cut


@pytest.mark.parametrize(
    ("error", "fault"),
    [
        (KeyboardInterrupt(), "interrupted"),
        (RuntimeError("parsing failed"), "parsing failed"),
        (RuntimeError(), "RuntimeError"),
        (OSError(5, "no such thing"), "[Errno 5] no such thing"),
    ],
)
@pytest.mark.parametrize("optimal", [False, True])
@pytest.mark.parametrize("many", [0, 2])
def test_what_an_error_has_ended_is_not_complete(seen, some, finder, error, fault, optimal, many):
    finder.found = [*some[:many], error, *some]
    answer = topomap.solve(seen, optimal=optimal)
    with pytest.raises(type(error)):
        len(answer)
    assert (len(answer), answer.complete, answer.fault) == (many, False, fault)
    assert finder.closed
    assert answer.kind == ("consistent" if many else "not settled")
    assert answer.proved == bool(many)
    assert repr(answer).endswith(f", partial: {fault}>")


def test_an_interrupt_of_the_caller_is_none_of_the_search(seen):
    answer = topomap.solve(seen)

    def interrupted():
        for _ in answer:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert (len(answer), answer.complete) == (88, True)


def test_what_nothing_is(seen):
    """Nothing is of no kind, so it is not "optimal"."""
    for optimal in (False, True):
        none = topomap.solve(seen, bound=3, optimal=optimal)
        assert (none.kind, none.complete, none.proved, none.cost) == ("no map", True, True, ())
        assert repr(none) == "<Answer: no map>"
        timed = topomap.solve(seen, optimal=optimal, timeout=0)
        assert (timed.kind, timed.fault, timed.proved) == ("not settled", "timeout", False)
        assert repr(timed) == "<Answer: no map found, partial: timeout>"


# What ends the search


def test_a_limit_ends_the_search(seen, some, finder):
    finder.found = some
    answer = topomap.solve(seen, limit=3)
    assert (len(answer), finder.closed, finder.given) == (3, True, 4)
    assert answer.fault == "limit"


def test_a_dropped_answer_ends_the_search(seen, some, finder):
    finder.found = some
    gc.disable()  # which would find it sooner or later
    try:
        answer = topomap.solve(seen)
        assert answer[1]
        gone = weakref.ref(answer)
        del answer
        assert gone() is None
        assert finder.closed
    finally:
        gc.enable()


def test_the_thread_of_a_dropped_answer_ends(larger):
    for _ in topomap.solve(larger):
        break
    assert topomap.solve(larger)[0]
    assert not threads._Run.live


def test_a_closed_answer_keeps_what_was_found(seen, some, finder):
    finder.found = some
    with topomap.solve(seen) as answer:
        first = answer[:2]
    assert finder.closed
    assert (answer[:], answer.fault, answer.complete) == (first, "closed", False)
    with topomap.solve(seen) as answer:
        assert len(answer) == 6
    answer.close()
    assert answer.complete
    never = topomap.solve(seen)
    never.close()
    assert ([*never], never.fault, never.kind) == ([], "closed", "not settled")
    assert repr(never) == "<Answer: no map found, partial: closed>"


def test_a_search_can_be_closed_while_another_thread_waits_for_it(seen, some, finder):
    searching = threading.Event()

    def go_on(watch):
        while finder.given == 2:
            searching.set()
            watch.tick()
            time.sleep(0.01)

    finder.found, finder.each = some, go_on
    answer = topomap.solve(seen)
    with waiting(lambda: len(answer)) as came:
        assert searching.wait(60)
        answer.close()
    assert (came, answer.fault) == ([2], "closed")


class waiting:
    """A thread that calls something, and is waited for; it gives the list of what came of it."""

    def __init__(self, *calls):
        self.came = []
        self.threads = [threading.Thread(target=self.run, args=[call]) for call in calls]

    def run(self, call):
        try:
            self.came.append(call())
        except BaseException as error:
            self.came.append(error)

    def __enter__(self):
        for thread in self.threads:
            thread.start()
        return self.came

    def __exit__(self, *_):
        for thread in self.threads:
            thread.join(60)


def test_no_worker_is_left_after_a_limit(seen):
    before = children()
    answer = topomap.solve(seen, limit=3, jobs=2)
    assert (len(answer), answer.fault) == (3, "limit")
    assert children() == before


def children():
    """The processes that this one has started."""
    found = []
    for task in Path("/proc/self/task").iterdir():
        with contextlib.suppress(FileNotFoundError):  # a thread that has just ended
            found += (task / "children").read_text().split()
    return sorted(found)


def test_who_waits_for_room_sleeps(larger):
    answer = topomap.solve(larger)
    assert answer[0]
    (run,) = threads._Run.live
    end = time.monotonic() + 60
    while len(run._items) < threads.AHEAD:
        assert time.monotonic() < end
        time.sleep(0.01)
    time.sleep(0.1)
    before = switches()
    time.sleep(1)
    # One that looks each 10 ms is woken 100 times.
    assert all(number - before.get(task, 0) < 50 for task, number in switches().items())
    assert len([*islice(answer, 3 * threads.AHEAD)]) == 3 * threads.AHEAD  # and wakes again


def switches():
    """How often each of the other threads has been woken."""
    found = {}
    for task in Path("/proc/self/task").iterdir():
        lines = (task / "status").read_text().splitlines()
        (line,) = [line for line in lines if line.startswith("voluntary_ctxt_switches")]
        if int(task.name) != threading.get_native_id():
            found[task.name] = int(line.split()[1])
    return found


# The time limit


@pytest.fixture
def clock(monkeypatch):
    """A clock that advances only when a test sets it."""

    class Clock:
        now = 1000.0

        def monotonic(self):
            return self.now

    made = Clock()
    monkeypatch.setattr("topomap.runtime.watch.time", made)
    return made


def test_the_time_limit_is_one_of_the_search(seen, some, finder, clock):
    """It begins with the search, and waits while the caller does something else."""

    def search(watch):
        clock.now += 1
        watch.tick()

    finder.found, finder.each = some, search
    answer = topomap.solve(seen, timeout=4.5)
    clock.now += 100
    for _ in answer:
        clock.now += 100
    assert (len(answer), answer.fault) == (4, "timeout")


def test_that_of_a_command_is_one_of_the_clock(some, finder, clock, inside, monkeypatch):
    def search(watch):
        clock.now += 1
        watch.tick()

    def write(report, found):
        clock.now += 1
        report.count += 1

    finder.found, finder.each = some, search
    monkeypatch.setattr("topomap.documents.answers.Report.add", write)
    done = inside("solve", GRID, "--timeout", "4.5")
    assert (done.returncode, finder.given) == (3, 2)


# What is looked for


def test_no_more_is_looked_for_than_is_asked(seen, some, finder):
    def given(of):
        finder.given = 0
        answer = topomap.solve(seen)
        of(answer)
        return finder.given

    finder.found = some
    for number, of in (
        (0, repr),
        (1, bool),
        (0, lambda answer: answer[0:0]),
        (1, lambda answer: answer[0:1]),
        (3, lambda answer: answer[:3]),
        (3, lambda answer: answer[np.int64(1) : np.int64(3)]),
        (4, lambda answer: answer[3::-1]),
        (4, lambda answer: answer[3:1:-2]),
        (2, lambda answer: answer[1]),
        (2, lambda answer: answer[np.int64(1)]),
        (6, lambda answer: answer[1:]),
        (6, lambda answer: answer[:-1]),
        (6, lambda answer: answer[-1]),
        (6, lambda answer: answer[:1:-1]),
        (6, lambda answer: answer[-3:5]),
    ):
        assert given(of) == number


def test_slices_are_those_of_a_list(seen, some, finder):
    finder.found = some
    whole = [*topomap.solve(seen)]
    ends = [None, -8, -2, 0, 1, 4, 9]
    for start in ends:
        for stop in ends:
            for step in (None, 1, 2, -1, -2):
                assert topomap.solve(seen)[start:stop:step] == whole[start:stop:step]
    with pytest.raises(IndexError):
        _ = topomap.solve(seen)[6]
    with pytest.raises(TypeError):
        _ = topomap.solve(seen)["first"]


def test_what_is_shown_is_what_is_known_by_now(seen):
    answer = topomap.solve(seen)
    shown = [repr(answer)]
    for number, _ in enumerate(answer):
        if number < 2:
            shown.append(repr(answer))
    shown.append(repr(answer))
    assert shown == [
        "<Answer: not begun>",
        "<Answer: 1 map so far, not finished>",
        "<Answer: 2 maps so far, not finished>",
        "<Answer: 88 consistent>",
    ]
    cut = topomap.solve(seen, limit=5)
    assert len(cut) == 5
    assert repr(cut) == "<Answer: 5 consistent, partial: limit>"


# Several who use one answer


def test_two_threads_on_one_answer(seen, some, finder):
    searching, go = threading.Event(), threading.Event()

    def search(watch):
        searching.set()
        assert go.wait(60)

    finder.found, finder.each = some, search
    answer = topomap.solve(seen)
    with waiting(lambda: [*answer]) as first:
        assert searching.wait(60)
        with waiting(lambda: [*answer], lambda: answer[2:5], lambda: len(answer)) as others:
            time.sleep(0.05)  # they come while the first one searches
            go.set()
    whole = [*answer]
    assert [one.found for one in whole] == some
    assert first == [whole]
    for one in (whole, whole[2:5], 6):
        assert one in others


def test_a_stream_keeps_nothing_and_the_answer_says_so(seen, some, finder):
    finder.found = some
    answer = topomap.solve(seen)
    stream = answer.stream()
    assert [next(stream).found, next(stream).found] == some[:2]
    assert (answer.complete, answer.kind, finder.given) == (False, "consistent", 2)
    for refused in (len, list, bool, lambda answer: answer[0], lambda answer: answer[:1]):
        with pytest.raises(ValueError, match="the maps go to a stream, and are not kept"):
            refused(answer)
    with pytest.raises(ValueError, match="before"):
        answer.stream()
    assert [one.found for one in stream] == some[2:]
    assert (answer.complete, repr(answer)) == (True, "<Answer: 6 consistent>")

    asked = topomap.solve(seen)
    assert asked[0]
    with pytest.raises(ValueError, match="before"):
        asked.stream()
    assert len(asked) == 6

    dropped = topomap.solve(seen)
    assert next(dropped.stream())
    assert (finder.closed, dropped.fault) == (True, "closed")


# Pictures in a notebook


def test_a_map_is_drawn_once(seen, some, finder, monkeypatch):
    finder.found = some
    drawn = []
    monkeypatch.setattr("topomap.api.draw.svg", lambda scene, late: drawn.append(scene) or "<svg/>")
    one = topomap.solve(seen)[0]
    assert [one._repr_svg_(), one._repr_svg_()] == ["<svg/>", "<svg/>"]
    assert len(drawn) == 1


@pytest.mark.slow
def test_a_picture_changes_nothing_of_the_process():
    text = f"""
import os, topomap
before = dict(os.environ)
one = topomap.solve(topomap.read({str(GRID)!r}), planar=True, optimal=True)[0]
assert one._repr_svg_().endswith("</svg>\\n")
assert dict(os.environ) == before
"""
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_kinds_come_from_what_was_found(seen, some, finder):
    """A map that is better than others is not the best one yet."""
    at = some[0].at
    finder.found = [Found(at, "optimal", (0, 6, 9), proved=False), MemoryError()]
    answer = topomap.solve(seen, optimal=True)
    assert ([one.at for one in answer], answer.fault) == ([at], "out of memory")
    assert (answer.kind, answer.proved) == ("not proved to be best", False)
