"""What the tests share: stock clingo on encodings and facts, without any of our driver."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import clingo
import hypothesis  # noqa: F401 -- else at the end, beside threads: Python 3.11 has a fault there
import pytest
from oracles.brute_force import Hypothesis, best, tree
from topomap.cli import main
from topomap.model.vocabulary import BEYOND, OPTIMIZING
from topomap.runtime.files import output
from topomap.solver.programs import FORMS

ROOT = Path(__file__).resolve().parents[1]
ENCODINGS = ROOT / "encodings"
PARTS = ("planar", "euler", "closed", "travelled", "boundary", "perpendicular")
COLUMNS = json.loads((ROOT / "scripts/topomap/paper/figure4.json").read_text())["columns"]
SHARED = ROOT.parent / "shared" / "maps"
BIN = Path(sys.executable).parent
# Under nohup, or in the background of a shell, SIGINT is ignored, and by all that is started.
signal.signal(signal.SIGINT, signal.default_int_handler)
ENDS = "passed", "failed", "error", "skipped"
BEGUN = time.monotonic()
TRIED = Counter()  # what was tried how often, for the last lines of a test run


def pytest_addoption(parser):
    parser.addoption("--tried", metavar="FILE", help="write there what was tried how often")
    parser.addoption(
        "--within", metavar="MINUTES", type=float, help="skip tests that would begin later"
    )


def pytest_runtest_setup(item):
    """On a slow machine the tests left out are reported, and the run ends in time."""
    minutes = item.config.getoption("within")
    if minutes is not None and time.monotonic() > BEGUN + 60 * minutes:
        pytest.skip(f"not begun within {minutes:g} minutes")


def pytest_sessionfinish(session):
    """One of several processes that run tests hands over what its tests have counted."""
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["tried"] = dict(TRIED)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """And the first one takes it."""
    TRIED.update(getattr(node, "workeroutput", {}).get("tried", {}))


def pytest_terminal_summary(terminalreporter):
    """What tests have counted, here and by record_property."""
    for report in terminalreporter.stats.get("passed", []):
        for what, number in report.user_properties:
            TRIED[what] += number
    for what, number in sorted(TRIED.items()):
        terminalreporter.write_line(f"tried: {number:,} {what}")
    if file := terminalreporter.config.getoption("tried"):
        with output(file, parents=True) as out:
            numbers = {end: len(terminalreporter.stats.get(end, ())) for end in ENDS}
            json.dump({**numbers, "tried": dict(sorted(TRIED.items()))}, out, indent=1)
            out.write("\n")


def forms(*parts):
    """The encodings that have these parts: the one that does the work, and the statement."""
    return [form for form in FORMS if all(part_file(form, part).is_file() for part in parts)]


def part_file(form, part):
    """The file of a part of the encoding."""
    return FORMS[form] / f"{BEYOND.get(part, part) if form == 'paper' else part}.lp"


def beyond(facts):
    """The files of encodings/paper/ for the facts that the paper does not have."""
    files = {
        "marker": "drop",
        "compass": "compass",
        "odometry": "shift",
        "lengths": "length",
        "closures": "same|apart",
        "logs": "start|look",
        "straight": "straight",
    }
    told = {file for file, names in files.items() if re.search(rf"\b(?:{names})\(", facts)}
    return [f"beyond/{file}" for file in files if file in told]


def answers(parts, facts, *arguments, encoding="work"):
    """The set of hypotheses, as tuples of (place, gateway) by step, that stock clingo
    finds; with a preference among the parts, the best ones. Fails on any message of
    clingo and on an answer given twice."""
    if OPTIMIZING & set(parts):
        arguments = *arguments, "--opt-mode=optN"
    return set(costs(parts, facts, *arguments, encoding=encoding))


def costs(parts, facts, *arguments, encoding="work"):
    """The same with what each costs; with a preference, of all if a bound is an argument."""
    messages = []
    optimal = "--opt-mode=optN" in arguments
    options = ["0", *arguments]
    control = clingo.Control(options, logger=lambda _, text: messages.append(text))
    more = beyond(facts) if encoding == "paper" else []
    if encoding == "paper" and any(one.startswith("tolerance=") for one in arguments):
        more.append("beyond/tolerance")
    for part in ("topomap", *more, *parts):
        control.load(str(part_file(encoding, part)))
    control.add("base", [], facts)
    control.ground([("base", [])])
    found = []

    def read(model):
        if optimal and not model.optimality_proven:
            return
        shown = [one for one in model.symbols(shown=True) if one.name != "exception"]
        at = sorted([a.number for a in one.arguments] for one in shown)
        assert [step for step, _, _ in at] == list(range(len(at)))
        found.append((tuple((place, slot) for _, place, slot in at), tuple(model.cost)))

    control.solve(on_model=read)
    assert not messages, messages
    assert len(found) == len(dict(found))
    return dict(found)


def plain(experience):
    """An experience as the oracle wants it."""
    turns = [
        turn if turn is not None else "start" if step in experience.starts else "look"
        for step, turn in enumerate(experience.turns, 1)
    ]
    done = {"drop": "put", "pick": "took", "marker": "saw"}
    return (
        experience.slots,
        experience.views,
        (None, *turns),
        experience.landmarks,
        {(step, "put") for step in experience.drops}
        | {(step, "took") for step in experience.picks}
        | {(step, "saw") for step in experience.markers}
        | {(step, done[kind], name) for kind, step, name in experience.things},
        known(experience),
    )


def known(experience):
    """What is known besides views, read from the facts that the encodings get."""
    numbers = r"(compass|shift|length|same|apart|straight)\((-?\d+),(-?\d+)(?:,(-?\d+))?\)"
    facts = re.findall(numbers, experience.facts())
    told = [(name, *(int(number) for number in rest if number)) for name, *rest in facts]
    if told:
        told += [("drift", experience.drift), ("stretch", experience.stretch)]
    if experience.tolerance:
        told.append(("tolerance", experience.tolerance))
    return told


class Truth:
    """What the independent search says of an experience, with or without the path axiom."""

    def __init__(self, experience, axiom=True):
        self.experience = plain(experience)
        self.levels = tree(self.experience, axiom=axiom)
        self.final = {at: Hypothesis(self.experience, at) for at in self.levels[-1]}

    def having(self, *parts, bound=None):
        """The final hypotheses that have all these properties."""
        tests = {
            "planar": lambda h: h.genus() == 0,
            "euler": lambda h: h.genus() == 0,
            "closed": Hypothesis.closed,
            "travelled": Hypothesis.travelled,
            "boundary": Hypothesis.boundary,
            "perpendicular": Hypothesis.perpendicular,
        }
        found = {at for at, h in self.final.items() if all(tests[part](h) for part in parts)}
        if bound is not None:
            found = {at for at in found if len(self.final[at].stars) <= bound}
        return found

    def least(self, key, hypotheses):
        """Those of the hypotheses whose figure is least."""
        figures = {at: key(self.final[at]) for at in hypotheses}
        fewest = min(figures.values(), default=None)
        return {at for at, figure in figures.items() if figure == fewest}

    def best(self, closed):
        return best(self.experience, self.final, closed)

    def planar_levels(self):
        return tree(self.experience, planar=True)


def run(*command, **options):
    """Run an installed command; returns the finished process, output as text."""
    program = shutil.which(command[0], path=BIN)
    return subprocess.run(
        [program, *map(str, command[1:])], capture_output=True, text=True, cwd=ROOT, **options
    )


def lacking(tool, why):
    """Skip, unless there is to be such a tool."""
    if os.environ.get(f"REQUIRE_{tool}") == "1":
        pytest.fail(f"REQUIRE_{tool}=1, but {why}")
    pytest.skip(why)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """Chromium, without a window."""
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not (program and driver):
        lacking("BROWSER", "no chromium and chromedriver")
    try:
        from selenium import webdriver
    except ImportError:
        lacking("BROWSER", "no selenium")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for option in (
        *("headless", "no-sandbox", "disable-gpu", "disable-quic", "no-first-run"),
        *("disable-background-networking", "disable-component-update", "disable-sync"),
        "disable-dev-shm-usage",
        f"user-data-dir={tmp_path_factory.mktemp('browser')}",
    ):
        options.add_argument(f"--{option}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(driver))
    yield driver
    driver.quit()


@pytest.fixture
def topomap():
    """The command ``topomap``, run from the repository's folder."""
    return lambda *arguments, **options: run("topomap", *arguments, **options)


@pytest.fixture
def inside(capsys, monkeypatch):
    """The command in this process: sooner, for what does not hang on one of its own."""
    monkeypatch.chdir(ROOT)

    def call(*arguments):
        capsys.readouterr()
        status = main([*map(str, arguments)])
        return subprocess.CompletedProcess(arguments, status, *capsys.readouterr())

    return call
