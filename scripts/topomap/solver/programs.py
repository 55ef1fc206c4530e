"""The programs of clingo: they are made of the encodings, then grounded and solved in a thread."""

import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any, TypeVar

import clingo

from topomap.model.experience import Experience
from topomap.model.found import Cube
from topomap.model.query import Query
from topomap.model.vocabulary import BEYOND
from topomap.runtime.errors import InputError
from topomap.runtime.folders import ENCODINGS
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import MEMORY, Stopped, Watch
from topomap.solver import phases
from topomap.solver.threads import Put, in_thread, prepare

FORMS = {"work": ENCODINGS, "paper": ENCODINGS / "paper"}
Answer = TypeVar("Answer")


def control(
    query: Query, facts: str, entry: Sequence[str] = ("topomap",), options: Sequence[str] = ()
) -> clingo.Control:
    """Make a control of clingo with the encodings, the entry files first, and the facts.

    It is not yet grounded.
    """
    arguments = ["0", *options]
    if query.optimizes:
        arguments.append("--opt-mode=optN")
    stated = query.encoding == "paper"
    files = [*entry, *(BEYOND.get(p, p) if stated else p for p in sorted(query.parts))]
    if query.places is not None:
        files.append("bound")
        arguments += ["-c", f"places={query.places}"]
    if query.noise is not None:
        files.append("noise")
        arguments += ["-c", f"noise={query.noise}"]
    if query.horizon is not None:
        arguments += ["-c", f"horizon={query.horizon}"]
    made = clingo.Control(arguments)
    for path in (FORMS[query.encoding] / f"{file}.lp" for file in files):
        if not path.is_file():
            raise InputError(f"{path}: not found; topomap is not installed as a whole")
        made.load(str(path))
    made.add("base", [], facts)
    return made


def beyond(experience: Experience) -> list[str]:
    """The files of encodings/paper/ for the facts that the paper does not consider."""
    needed = {
        "marker": experience.drops or experience.things,
        "logs": experience.parted,
        "compass": experience.compass,
        "odometry": experience.shifts,
        "lengths": experience.lengths,
        "closures": experience.same or experience.apart,
        "straight": experience.straight,
        "tolerance": experience.tolerance,
    }
    return [f"beyond/{name}" for name, told in needed.items() if told]


class Program:
    """The program of a query with more facts, which is grounded when it is first solved."""

    def __init__(self, experience: Experience, query: Query, facts: str = ""):
        self.asked = experience, query
        self.facts = facts
        self._phased = query.encoding == "work" and phases.serve(experience, query)
        entry, options = ["topomap"], experience.constants()
        if self._phased:
            entry, more = phases.program(experience, query)
            options += more
        elif query.encoding == "paper":
            if experience.straight and query.parts & {"boundary", "exceptions"}:
                said = "the statement has no left and right of paths whose gateways are given"
                raise InputError(f"{said}: not with straight/3")
            entry += beyond(experience)
        if experience.assumed:
            query = query.having("query")
        told = experience.facts() + facts + experience.assumptions("explain" in query.parts)
        self.control = control(query, told, entry, options)
        self._grounded = self._interrupted = False
        self.changed = False  # whether rules were added that exclude answers
        self._solved = self.control  # the control that is being solved, or is next
        self.say: Callable[[str], None] = lambda _: None

    def solve(
        self,
        cube: Cube,
        more: Sequence[tuple[clingo.Symbol, bool]] = (),
        on_model: Callable[[clingo.Model], bool] | None = None,
    ) -> clingo.SolveResult:
        """Solve the program for the hypotheses that begin with a cube."""
        if not self._grounded:
            if self._phased:
                facts = phases.found(*self.asked, ENCODINGS, self._heed, self.say)
                self._heed(self.control)
                self.say("")
                self.control.add("base", [], facts)
                if "rare(" in facts:
                    self.control.configuration.solver.heuristic = "Domain"  # type: ignore[union-attr]
            self.control.ground()
            self._heed(self.control)
            self._grounded = True
        return self.control.solve([*_assumed(cube), *more], on_model=on_model)

    def _heed(self, control: clingo.Control) -> None:
        self._solved = control
        if self._interrupted:
            raise Stopped(INTERRUPT)

    def interrupt(self) -> None:
        """End the call of another thread as soon as it has grounded."""
        self._interrupted = True
        self._solved.interrupt()

    def keep(self) -> None:
        """Keep the program, with what it has learnt, for the next call of this thread."""
        if not (self.asked[1].optimizes or self.changed):
            _last.program = self

    def models(self) -> tuple[int, tuple[float, ...]]:
        """The number of answers of the last call.

        If the query minimises, it is the number of best answers, and their cost.
        """
        summary = self.control.statistics["summary"]
        if not self.asked[1].optimizes:
            return int(summary["models"]["enumerated"]), ()
        return int(summary["models"]["optimal"]), tuple(summary["costs"])


class _Last(threading.local):
    """The program that each thread has kept."""

    program: Program | None = None


_last = _Last()


def forget() -> None:
    """Free the program that this thread has kept."""
    _last.program = None


def program_of(experience: Experience, query: Query, facts: str = "") -> Program:
    """The program of a query: the one that was kept, or a new one."""
    prepare()
    program, _last.program = _last.program, None
    if program is None or (*program.asked, program.facts) != (experience, query, facts):
        program = None  # its memory is freed before the next one is made
        try:
            program = Program(experience, query, facts)
        except MemoryError:
            raise Stopped(MEMORY) from None
    return program


def calls(
    experience: Experience,
    query: Query,
    facts: str,
    watch: Watch,
    work: Callable[[Program, Put], None],
) -> Iterator[Any]:
    """Give what ``work`` puts, which may solve the program of a query several times.

    Raises:
        Stopped: The time limit has passed, or memory ran out.
    """
    program = program_of(experience, query, facts)
    return in_thread(program, watch, partial(work, program))


def answers(
    experience: Experience,
    query: Query,
    watch: Watch,
    read: Callable[[clingo.Model], Answer | None],
    cubes: Iterable[Cube] | None = None,
) -> Iterator[Answer | None]:
    """Give what ``read`` makes of each model, in the solver's order.

    A model of which it makes None is passed over. With ``cubes``, the models that begin with the
    first of them come first, then a None, and so on.

    Raises:
        Stopped: The time limit has passed, or memory ran out.
    """
    program = program_of(experience, query)

    def work(put: Put) -> None:
        """Solve the program, and put what is read."""
        going = True

        def take(model: clingo.Model) -> bool:
            """Put what is read of a model."""
            nonlocal going
            watch.found += 1
            answer = read(model)
            if answer is not None:
                going = put(answer)
            return going

        for cube in [()] if cubes is None else cubes:
            program.solve(cube, on_model=take)
            if cubes is not None:
                going = going and put(None)
            if not going:
                break

    return in_thread(program, watch, work)


def _assumed(cube: Cube) -> list[tuple[clingo.Symbol, bool]]:
    return [
        (clingo.Function("at", [clingo.Number(number) for number in (step, *dstate)]), True)
        for step, dstate in enumerate(cube)
    ]
