"""One measurement, in a process of its own.

Reads a task as JSON on standard input. Writes a line of JSON on the task, then one on the
answer; at its time limit the system ends it in between, whatever it is doing.
"""

import dataclasses
import gc
import json
import os
import resource
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import clingo
from topomap.documents.check import by_definition
from topomap.model.experience import DState, Experience
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.paper import figure4
from topomap.paper.statistics import Tally, tree
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Stopped, Watch
from topomap.search import traversal
from topomap.search.descent import Descent
from topomap.solver import programs, solving

At = tuple[DState, ...]


class Control(clingo.Control):
    """A clingo that tells its figures when it goes."""

    made = told = 0
    figures: ClassVar[Counter[str]] = Counter()

    def __init__(self, *arguments: Any, **named: Any):
        super().__init__(*arguments, **named)
        self.configuration.stats = 1  # figures of all calls of solve together, under "accu"
        Control.made += 1

    def __del__(self) -> None:
        statistics = self.statistics
        program, solvers = statistics["problem"]["lp"], statistics["accu"]["solving"]["solvers"]
        for name, group in (
            ("rules", program),
            ("atoms", program),
            ("choices", solvers),
            ("conflicts", solvers),
        ):
            Control.figures[name] += int(group[name])
        Control.told += 1
        super().__del__()


def told() -> dict[str, int]:
    """Rules, atoms, choices and conflicts of all clingos; none if one did not report them."""
    programs.forget()
    gc.collect()
    return dict(Control.figures) if Control.made == Control.told else {}


@dataclasses.dataclass
class Task:
    """What is asked; ``nodes`` that a search has visited, and the maps that were listed."""

    ask: str
    query: Query
    experience: Experience
    truth: At = ()
    nodes: int = 0
    found: list[At] = dataclasses.field(default_factory=list)


def counted(task: Task) -> int:
    """All maps, as ``topomap count`` has them: with no Python object for any."""
    return solving.count(task.experience, task.query, grown=False)[0]


def listed(task: Task) -> int:
    """All maps, as ``topomap solve`` has them."""
    found = solving.hypotheses(task.experience, task.query, Watch())
    task.found = [one.at for one in found if one]
    return len(task.found)


def one(task: Task) -> int:
    """The first map."""
    first = next(solving.hypotheses(task.experience, task.query, Watch()), None)
    task.found = [first.at] if first else []
    return len(task.found)


def table(task: Task) -> int:
    """How many figures of the paper's table differ, counted a column after the other."""
    differences = 0
    for column, experience, query in _columns(task.query.encoding):
        figures: dict[str, Any] = {}
        tree(experience, query, Watch(), Journal(), figures)
        differences += len(figure4.differences(column | figures))
    return differences


def command(_: Task) -> int:
    """The same, as ``topomap table`` counts them."""
    return sum(len(figure4.differences(row)) for row in figure4.rows(os.cpu_count() or 1, Watch()))


def counted_by_search(task: Task) -> int:
    return sum(1 for _ in _searched(task))


def listed_by_search(task: Task) -> int:
    task.found = [*_searched(task)]
    return len(task.found)


def one_by_search(task: Task) -> int:
    task.found = [*islice(_searched(task), 1)]
    return len(task.found)


def table_by_search(task: Task) -> int:
    differences = 0
    for column, experience, query in _columns("work"):
        tally = Tally(experience.steps)
        for node in traversal.depth_first(traversal.root(experience, query)):
            tally.add(node)
        task.nodes += sum(tally.per_step)
        differences += len(figure4.differences(column | tally.figures()))
    return differences


def _columns(encoding: str) -> Iterator[tuple[dict[str, Any], Experience, Query]]:
    for column in figure4.COLUMNS:
        parts = frozenset(["planar"] if column["planarity"] else [])
        experience = read(figure4.INSTANCES / f"{column['instance']}.lp")
        yield column, experience, Query(parts, column["places"], encoding=encoding)


def _searched(task: Task) -> Iterator[At]:
    """The maps, by the search that looks ahead."""
    descent = Descent(task.experience, task.query)
    for found in descent.found():
        task.nodes = descent.nodes
        if found:
            yield found.at
    task.nodes = descent.nodes


# How each way does what is asked. A way of another kind is another entry here.
Way = Callable[[Task], int]
CLINGO: dict[str, Way] = {"count": counted, "maps": listed, "one": one, "table": table}
WAYS: dict[str, dict[str, Way]] = {
    "baseline": CLINGO,
    "work": CLINGO | {"command": command},
    "search": {
        "count": counted_by_search,
        "maps": listed_by_search,
        "one": one_by_search,
        "table": table_by_search,
    },
}


def faults(task: Task) -> Iterator[str]:
    """What is wrong with the maps that were listed."""
    if len(set(task.found)) != len(task.found):
        yield "a map is given twice"
    if task.ask == "maps" and task.truth not in task.found:
        yield "the real map is not among them"
    if task.ask == "one":
        demands = sorted(task.query.parts)
        demands += [f"bound({task.query.places})"] if task.query.places else []
        for at in task.found:
            triples = [(step, *dstate) for step, dstate in enumerate(at)]
            for rule, step in by_definition(task.experience, triples, demands):
                yield f"{rule} is broken at step {step}"


def main() -> None:
    given = json.load(sys.stdin)
    way = given["way"]
    programs.FORMS["baseline"] = Path(given["baseline"])
    task = Task(given["ask"], Query(), Experience(2, (frozenset([0]),), (), (frozenset(),)))
    about = {}
    if given["instance"]:
        task.experience = read(given["instance"])
        truth = json.loads(Path(given["truth"]).read_text())["maps"][0]["at"]
        task.truth = tuple((place, slot) for _, place, slot in truth)
        real = len({place for place, _ in task.truth})
        seen = zip(task.experience.views, task.experience.landmarks, strict=True)
        about = {"steps": task.experience.steps, "kinds": len(set(seen)), "real places": real}
        places = real if given["places"] == "real" else given["places"]
        task.query = Query(frozenset(given["parts"]), places)
    task.query = dataclasses.replace(task.query, encoding="work" if way == "search" else way)
    print(json.dumps(about), flush=True)
    if given["memory"]:
        resource.setrlimit(resource.RLIMIT_AS, (given["memory"] << 20, given["memory"] << 20))
    clingo.Control = Control  # type: ignore[misc]
    before = _memory()
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, given["limit"])
    begun, used = time.perf_counter(), time.process_time()
    try:
        number = WAYS[way][task.ask](task)
    except (MemoryError, Stopped):
        print(json.dumps({"cut": "memory"}), flush=True)
        os._exit(0)
    seconds, used = time.perf_counter() - begun, time.process_time() - used
    signal.setitimer(signal.ITIMER_REAL, 0)
    answer = {"number": number, "seconds": seconds, "processor seconds": used}
    answer |= {"memory": _memory(), "memory before": before}
    answer |= {"nodes": task.nodes} if way == "search" else told()
    print(json.dumps(answer | {"faults": list(faults(task))}), flush=True)


def _memory() -> float:
    """The most memory that the process had, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main()
