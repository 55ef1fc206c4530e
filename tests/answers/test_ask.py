"""``topomap ask`` against enumerated maps: what holds of each is computed by the independent
search's own means, and the statements are written here and read there."""

import json
import random
import re

import clingo
import pytest
from conftest import ENCODINGS, ROOT, TRIED, Truth, plain, run
from oracles.brute_force import Hypothesis
from oracles.statements import FIGURES, PROPERTIES, QUALITIES, RELATIONS, relation
from oracles.worlds import WORLDS, random_experience
from topomap.documents.check import by_definition, by_rules
from topomap.model import vocabulary
from topomap.model.facts import parse, read
from topomap.model.query import Query
from topomap.questions import ask, statements
from topomap.questions.ask import Inquiry
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Stopped, Watch
from topomap.solver.programs import forget
from topomap.solver.solving import hypotheses

SIGNS = {
    "<": int.__lt__,
    "<=": int.__le__,
    "=": int.__eq__,
    "!=": int.__ne__,
    ">=": int.__ge__,
    ">": int.__gt__,
}
ANY = Query()
GRIDS = {name: read(ROOT / f"instances/grid-{name}.lp") for name in ("3x3-snake", "4x4-snake")}


def test_each_statement_of_the_vocabulary_is_defined_a_second_time():
    """A new part of the theory is a statement at once; a meaning of it must not be forgotten."""
    assert {*PROPERTIES} == {*vocabulary.PROPERTIES}
    assert {*QUALITIES} == {*vocabulary.QUALITIES}
    assert {*RELATIONS} == {*vocabulary.RELATIONS}
    assert {*FIGURES} == {*vocabulary.FIGURES}


def statement(draw, experience):
    """A statement, and what it says of a hypothesis; of gateways that were seen, mostly."""
    kind = draw.choice([*RELATIONS, *RELATIONS, *FIGURES, *QUALITIES])
    space = draw.choice(["", "", " ", "  ", "\n\t"])
    if kind in RELATIONS and (kind != "pending" or draw.random() < 0.5):
        numbers = relation(draw, experience, kind)
        text = f"{kind}{space}({f'{space},{space}'.join(map(str, numbers))}{space})"
        test = RELATIONS[kind]
    elif kind in FIGURES:
        sign = draw.choice([*SIGNS])
        number = draw.choice([*range(max(3, experience.steps)), 0, 1, 2**31 - 1])
        text, numbers = f"{space}{kind}{space}{sign}{space}{number}", []
        test = lambda h: SIGNS[sign](FIGURES[kind](h), number)  # noqa: E731
    else:
        text, numbers, test = kind, [], QUALITIES[kind]
    negations = draw.choice([0, 0, 0, 1, 2])
    return "not  " * negations + text, lambda h: test(h, *numbers) == (negations % 2 == 0)


def settled(experience, texts, query=ANY, optimal=False):
    """What the command finds."""
    answers = Inquiry([statements.parse_statement(text, experience, "ask") for text in texts])
    answers.settle(experience, query, optimal, Watch())
    return answers


def demand(answers, experience, tests, maps, demands=()):
    """The answers are those of the maps that there are, and show maps that do show it."""
    assert answers.some == bool(maps)
    shown = {}
    for answer, test in zip(answers.each, tests, strict=True):
        true = {at for at, h in maps.items() if test(h)}
        known = (
            None if not maps else "all" if len(true) == len(maps) else "some" if true else "none"
        )
        assert answer.holds == known, answer.statement
        assert (answer.witness is not None) == (known in ("all", "some"))
        assert (answer.counter is not None) == (known in ("none", "some"))
        if answer.statement.note:
            assert known in (None, "none" if answer.statement.positive else "all")
        for found, right in (answer.witness, True), (answer.counter, False):
            if found:
                assert found.at in maps
                assert (found.at in true) == right
                shown[found.at] = [(step, *dstate) for step, dstate in enumerate(found.at)]
        TRIED[f"statements asked, {known}"] += 1
    for at in shown.values():
        assert not by_rules(experience, at, demands)
        assert not by_definition(experience, at, demands)
        TRIED["maps that ask shows, checked"] += 1


def drawn(draw, number, axiom=True):
    """An experience, as a rule one of several maps, and what the independent search says of it,
    with or without the path axiom."""
    while True:
        experience = draw.choice([*WORLDS.values()]) if number % 4 == 0 else None
        if experience is None or experience.steps > 9:
            experience = random_experience(draw, draw.choice([5, 7, 9]))
        truth = Truth(experience, axiom)
        if number % 8 == 1 or 1 < len(truth.final) < 100:
            return experience, truth


@pytest.mark.slow
@pytest.mark.parametrize("cases", [30, pytest.param(1000, marks=pytest.mark.long)])
def test_answers_are_those_of_all_maps(cases):
    for number in range(cases):
        draw = random.Random(f"ask {cases} {number}")
        experience, truth = drawn(draw, number)
        texts, tests = zip(*(statement(draw, experience) for _ in range(12)), strict=True)
        parts = [part for part in PROPERTIES if draw.random() < 0.12]
        bound = draw.choice([None, None, None, 3, 5])
        maps = {at: truth.final[at] for at in truth.having(*parts, bound=bound)}
        found = settled(experience, texts, Query(frozenset(parts), bound))
        demand(found, experience, tests, maps, [*parts, *([f"bound({bound})"] if bound else [])])
        best = truth.best(True) or truth.best(False)
        found = settled(experience, texts, ANY, optimal=True)
        demand(found, experience, tests, {at: truth.final[at] for at in best})
        assert found.kind == ("optimal" if truth.best(True) else "best so far")


@pytest.mark.slow
@pytest.mark.parametrize("cases", [40, pytest.param(1000, marks=pytest.mark.long)])
def test_answers_without_the_path_axiom(cases):
    """Loops, circular paths and paths that cross themselves count right."""
    tried = set()
    for number in range(cases):
        draw = random.Random(f"no axiom {cases} {number}")
        experience, truth = drawn(draw, number, axiom=False)
        texts, tests = zip(*(statement(draw, experience) for _ in range(6)), strict=True)
        figures = [("paths", FIGURES["paths"]), ("exceptions", FIGURES["exceptions"])]
        more = [
            (f"{name} {sign} {count}", lambda h, f=f, sign=sign, n=count: SIGNS[sign](f(h), n))
            for name, f in figures
            for sign in draw.sample([*SIGNS], 2)
            for count in [f(draw.choice([*truth.final.values()]))]
        ]
        more += [(name, QUALITIES[name]) for name in ("circular", "meets_twice", "boundary")]
        texts, tests = zip(*zip(texts, tests, strict=True), *more, strict=True)
        parts = [part for part in PROPERTIES if draw.random() < 0.12]
        maps = {at: truth.final[at] for at in truth.having(*parts)}
        query = Query(frozenset([*parts, "no_path_axiom"]))
        found = settled(experience, texts, query)
        demand(found, experience, tests, maps, [*parts, "no_path_axiom"])
        tried |= {(one.statement.term, one.holds) for one in found.each}
    assert tried >= {("circular", "some"), ("meets_twice", "some"), ("circular", "none")}


def test_no_path_is_circular_by_the_path_axiom():
    """So the statement is settled by it, in each map."""
    for number in range(10):
        experience, truth = drawn(random.Random(f"circular {number}"), number)
        demand(settled(experience, ["circular"]), experience, [QUALITIES["circular"]], truth.final)


@pytest.mark.parametrize("part", ["genus", "minimal"])
def test_what_is_preferred_may_be_any_part(part):
    for number in range(10):
        draw = random.Random(f"preferred {part} {number}")
        experience, truth = drawn(draw, number)
        pairs = [statement(draw, experience) for _ in range(6)]
        texts, tests = zip(*pairs, strict=True)
        key = Hypothesis.genus if part == "genus" else Hypothesis.cost
        maps = {at: truth.final[at] for at in truth.least(key, truth.final)}
        found = settled(experience, texts, Query(frozenset([part])))
        demand(found, experience, tests, maps)
        assert found.kind == "best"


def consequences(parts, facts, mode):
    """What stock clingo shows of statements, by the call in the header of query.lp."""
    options = ["0", f"--enum-mode={mode}", *(["--opt-mode=optN"] if "minimal" in parts else [])]
    messages, shown = [], None
    control = clingo.Control(options, logger=lambda _, text: messages.append(text))
    for part in ("topomap", "query", *parts):
        control.load(str(ENCODINGS / f"{part}.lp"))
    control.add("base", [], facts)
    control.ground()
    with control.solve(yield_=True) as models:
        for model in models:
            shown = {str(a.arguments[0]) for a in model.symbols(shown=True) if a.name == "holds"}
    assert not messages
    return shown


@pytest.mark.slow
@pytest.mark.parametrize("cases", [20, pytest.param(300, marks=pytest.mark.long)])
def test_stock_clingo_says_the_same(cases):
    for number in range(cases):
        draw = random.Random(f"stock {number}")
        experience, _ = drawn(draw, number)
        texts = [statement(draw, experience)[0] for _ in range(8)]
        parts = draw.choice([[], ["planar"], ["boundary", "minimal"], ["closed"]])
        answers = settled(experience, texts, Query(frozenset(parts)))
        facts = experience.facts() + "".join(a.statement.fact for a in answers.each)
        certain, possible = (consequences(parts, facts, mode) for mode in ("cautious", "brave"))
        assert (certain is None) == (possible is None) == (not answers.some)
        for answer in answers.each if answers.some else ():
            term, positive = answer.statement.term, answer.statement.positive
            known = "all" if term in certain else "some" if term in possible else "none"
            turned = {"all": "none", "some": "some", "none": "all"}
            assert answer.holds == (known if positive else turned[known])


def test_what_is_not_asked_is_not_grounded():
    def atoms(*files):
        control = clingo.Control()
        for file in ("topomap", *files):
            control.load(str(ENCODINGS / f"{file}.lp"))
        control.add("base", [], GRIDS["3x3-snake"].facts())
        control.ground()
        return {str(atom.symbol) for atom in control.symbolic_atoms}

    assert atoms("query") == atoms()


def test_the_visits_of_the_3x3_snake(topomap):
    """All pairs at once, of all its maps."""
    experience = GRIDS["3x3-snake"]
    truth = Truth(experience)
    pairs = [(t, u) for t in range(17) for u in range(t)]
    tests = [lambda h, t=t, u=u: RELATIONS["same"](h, t, u) for t, u in pairs]
    found = settled(experience, [f"same({t},{u})" for t, u in pairs])
    demand(found, experience, tests, truth.final)


# The figures are those of the paper's Figure 4 and of its text, and of Figures 1 and 5.
PAPER = [
    ("3x3-snake", ["--optimal"], {"planar": "some", "places = 9": "all", "genus <= 1": "all"}),
    ("3x3-snake", ["--optimal", "--planar"], {"planar": "all", "closed": "all", "paths=6": "all"}),
    ("3x4-paper", ["--optimal"], {"planar": "some", "not planar": "some"}),
    (
        "4x4-snake",
        ["--optimal"],
        {"places = 12": "all", "paths = 6": "all", "links = 18": "all", "planar": "all"},
    ),
    ("4x4-snake", ["--optimal"], {"perpendicular": "none", "places >= 13": "none"}),
    ("4x4-snake", ["--planar", "--bound=16"], {"closed": "some", "places > 16": "none"}),
    (
        "4x4-snake",
        ["--planar", "--closed", "--bound=16"],
        {"perpendicular": "some", "not closed": "none", "travelled": "all"},
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "arguments", "known"), PAPER)
def test_papers_instances(topomap, tmp_path, name, arguments, known):
    instance = ROOT / f"instances/grid-{name}.lp"
    done = topomap("ask", instance, *known, *arguments, "--json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert {one["statement"]: one["holds"] for one in answer["statements"]} == known
    maps = [one[key] for one in answer["statements"] for key in ("witness", "counter") if one[key]]
    seen = {json.dumps(one): one for one in maps}
    file = tmp_path / "maps.json"
    file.write_text(json.dumps([*seen.values()]))
    demands = ["--boundary"] if "--optimal" in arguments else arguments
    assert topomap("check", instance, file, *demands).returncode == 0
    lines = topomap("ask", instance, *known, *arguments).stdout.splitlines()
    assert [line for line in lines if not line.startswith(" ")][:-1] == [
        f"{text}: in {holds}" for text, holds in known.items()
    ]
    assert len(lines) == len(maps) + len(known) + 1


@pytest.mark.slow
def test_what_is_asked_of_the_4x4_snake_is_what_its_maps_say():
    experience = GRIDS["4x4-snake"]
    query = Query(frozenset(["planar", "closed"]), 16)
    maps = [found.at for found in hypotheses(experience, query, Watch())]
    assert len(maps) == 6
    whole = {at: Hypothesis(plain(experience), at) for at in maps}
    draw = random.Random("snake")
    texts, tests = zip(*(statement(draw, experience) for _ in range(60)), strict=True)
    demand(settled(experience, texts, query), experience, tests, whole, ["planar", "closed"])


def test_stock_call_in_the_header(tmp_path):
    instance, asked = ROOT / "instances/grid-3x3-snake.lp", tmp_path / "asked.lp"
    texts = ["same(3,12)", "places >= 5", "places >= 9", "planar", "same(0,1)"]
    answers = settled(GRIDS["3x3-snake"], texts).each
    asked.write_text("".join(answer.statement.fact for answer in answers))
    head = (ENCODINGS / "query.lp").read_text()
    (call,) = re.findall(r"%     (clingo .*\n%  +0 --enum-mode=cautious)", head)
    for mode, kinds in ("cautious", {"all"}), ("brave", {"all", "some"}):
        words = call.replace("%", "").replace("[encodings/PART.lp ...]", "").split()[:-1]
        files = {"INSTANCE": instance, "ASKED": asked}
        done = run(*(files.get(word, word) for word in words), f"--enum-mode={mode}", "--outf=2")
        last = json.loads(done.stdout)["Call"][0]["Witnesses"][-1]["Value"]
        wanted = {f"holds({one.statement.term})" for one in answers if one.holds in kinds}
        assert {atom for atom in last if atom.startswith("holds(")} == wanted
        assert wanted


REFUSED = [
    ("same(3,99)", "step 99: the experience has 16 steps"),
    ("same(17,0)", "step 17: the experience has 16 steps"),
    ("linked(3,4,12,0)", "slot 4: slots are 0 to 3"),
    ("at(3,17,0)", "place 17: the experience has 16 steps"),
    ("same(3)", "same: its arguments are step, step: same(...); there are 1 arguments"),
    ("same(3,4,5)", "same: its arguments are step, step: same(...); there are 3 arguments"),
    ("same(-1,2)", "step '-1': a whole number is wanted, 0 to 2147483647"),
    ("same(3,x)", "step 'x': a whole number is wanted, 0 to 2147483647"),
    ("same(3,\u0663)", "step '\u0663': a whole number is wanted, 0 to 2147483647"),
    ("places < 2147483648", "number '2147483648': a whole number is wanted, 0 to 2147483647"),
    ("places < ", "number '': a whole number is wanted, 0 to 2147483647"),
    ("places == 3", "number '= 3': a whole number is wanted, 0 to 2147483647"),
    ("places", "places: it is a number, to be compared: places < 12"),
    ("streets < 3", "streets: not a number of a map"),
    ("planar = 1", "planar: not a number of a map"),
    ("planar()", "planar: it is about the whole map, so it has no arguments"),
    ("same", "same: its arguments are step, step: same(...)"),
    ("square", "square: no such word; did you mean same?"),
    ("met(1,2)", "met: no such word; there are same, linked,"),
    ("", "not a statement, such as same(3,12)"),
    ("not", "not: no such word"),
    ("same(3,12).", "not a statement, such as same(3,12)"),
    ("same(3,12) planar", "not a statement, such as same(3,12)"),
    ("planar, closed", "not a statement, such as same(3,12)"),
    ("same(3,(12))", "not a statement, such as same(3,12)"),
    ("#show at/3.", "not a statement, such as same(3,12)"),
]


@pytest.mark.parametrize(("text", "fault"), REFUSED)
def test_bad_statements_are_refused(text, fault):
    said = refused(text, GRIDS["3x3-snake"])
    assert said.startswith(f'ask: "{text.strip()}": {fault}')


def test_a_bad_statement_ends_the_command(topomap, tmp_path):
    out = tmp_path / "answer"
    for words in (["planar", "same(3,99)"], ["--horizon=5", "same(3,9)"]):
        done = topomap("ask", ROOT / "instances/grid-3x3-snake.lp", *words, "-o", out)
        assert (done.returncode, done.stdout) == (2, "")
        assert re.fullmatch(
            r'ask: "same\(3,9+\)": step 9+: the experience has \d+ steps\n', done.stderr
        )
        assert not out.exists()


def refused(text, experience):
    """Why a text is not a statement, or None."""
    try:
        statements.parse_statement(text, experience, "ask")
    except InputError as fault:
        return str(fault)
    return None


PIECES = [
    *("same", "linked", "path", "pending", "at", "not", "planar", "closed", "places", "genus"),
    *("(", ")", ",", "<", "<=", "=", "!=", ">", " ", "\n", "\0", "\x1b", "\ud800", "\u0663", "é"),
    *("0", "1", "3", "12", "99", "2147483647", "9" * 30, "9" * 5000, "-1", "1.5", ".", "%", '"'),
    *(
        "not " * 2000,
        "(" * 5000,
        "same(1,2)",
        "linked(3,1,2,0)",
        "X",
        "ask(planar)",
        ";",
        "..",
        "_",
    ),
]


def test_any_text_is_a_statement_or_is_refused_in_one_line():
    experience = GRIDS["3x3-snake"]
    accepted = 0
    for number in range(5000):
        draw = random.Random(f"text {number}")
        text = statement(draw, experience)[0] if number % 2 else ""
        for _ in range(draw.randint(0 if text else 1, 6)):
            cut = draw.randint(0, len(text))
            text = text[:cut] + draw.choice(PIECES) + text[cut + draw.choice([0, 0, 1, 5]) :]
        fault = refused(text, experience)
        if fault is None:
            accepted += 1
            made = statements.parse_statement(text, experience, "ask")
            assert statements.parse_statement(made.text, experience, "ask") == made
            assert str(clingo.parse_term(made.term)) == made.term
        else:
            assert re.fullmatch('ask: ".{3,300}', fault)
    assert 300 < accepted < 4500


class Impatient(Watch):
    """It stops after so many maps."""

    def __init__(self, most):
        super().__init__()
        self.most = most

    def tick(self):
        if self.found >= self.most:
            raise Stopped("timeout")


def test_what_is_not_settled_says_so():
    experience = GRIDS["3x3-snake"]
    texts = ["same(0,16)", "not same(0,16)", "planar", "places >= 1"]
    answers = Inquiry([statements.parse_statement(text, experience, "ask") for text in texts])
    assert {answer.words() for answer in answers.each} == {"not settled"}
    with pytest.raises(Stopped):
        answers.settle(experience, Query(), False, Impatient(1))
    assert [answer.holds for answer in answers.each] == [None] * 4
    words = [answer.words() for answer in answers.each]
    assert set(words) == {"not settled: in some or all", "not settled: in some or none"}
    assert words[0] != words[1]
    assert words[3] == "not settled: in some or all"
    with pytest.raises(Stopped):
        answers.settle(experience, Query(), False, Impatient(2))
    assert answers.each[0].holds == "some"


@pytest.mark.parametrize("as_json", [False, True])
def test_time_limit(topomap, as_json):
    words = ["planar", "same(3,12)", "--timeout=0.001", *["--json"] * as_json]
    done = topomap("ask", ROOT / "instances/grid-4x4-snake.lp", *words)
    assert done.returncode == 3
    if as_json:
        answer = json.loads(done.stdout)
        assert (answer["complete"], answer["fault"]) == (False, "timeout")
        assert {one["holds"] for one in answer["statements"]} == {None}
    else:
        wanted = ["planar: not settled", "same(3,12): not settled", "partial: timeout"]
        assert done.stdout.splitlines() == wanted


@pytest.mark.long
def test_what_is_hard_to_settle_holds_up_nothing_else(topomap):
    """Whether 30 places are enough takes long, the path a second."""
    words = ["places < 30", "path(3,0,12,0)", "linked(3,1,12,0)", "--timeout=8", "--json"]
    done = topomap("ask", ROOT / "instances/manhattan-tour88-signs30.lp", *words)
    hard, *easy = (one["holds"] for one in json.loads(done.stdout)["statements"])
    assert easy == ["none", "none"]
    assert done.returncode == (3 if hard is None else 0)


def test_answers_do_not_depend_on_what_is_put_off(monkeypatch):
    """However few the conflicts until a statement is put off."""
    experience = GRIDS["3x3-snake"]
    texts = ["places < 8", "planar", "same(0,16)", "path(0,0,7,0)", "genus < 4", "same(1,9)"]
    for optimal in (False, True):
        found = []
        for budgets in (("umax",), ("0", "1", "2", "umax")):
            monkeypatch.setattr(ask, "BUDGETS", budgets)
            forget()
            answers = settled(experience, texts, Query(), optimal=optimal)
            found.append([answer.holds for answer in answers.each])
        assert found[0] == found[1]
        assert None not in found[0]


@pytest.mark.slow
def test_no_map(topomap):
    instance = ROOT / "instances/grid-3x3-snake.lp"
    for extra in (["--bound=3"], ["--bound=3", "--optimal"]):
        done = topomap("ask", instance, "planar", "not planar", *extra)
        assert (done.returncode, done.stdout) == (1, "no map is consistent with it\n")
        answer = json.loads(topomap("ask", instance, "planar", *extra, "--json").stdout)
        assert answer["has_maps"] is False
        assert answer["complete"] is True
        assert answer["statements"] == []


def test_a_gateway_that_was_not_seen(topomap):
    words = ["linked(3,1,12,0)", "not pending(3,1)", "at(2,7,0)"]
    done = topomap("ask", ROOT / "instances/grid-3x3-snake.lp", *words)
    lines = [line for line in done.stdout.splitlines() if not line.startswith(" ")]
    assert lines == [
        "linked(3,1,12,0): in none: no gateway was seen 1 slot clockwise after step 3",
        "not pending(3,1): in all: no gateway was seen 1 slot clockwise after step 3",
        "at(2,7,0): in none: place 7 is named by a later step than 2",
        "of the consistent maps",
    ]


def test_an_experience_without_steps():
    experience = parse("slots(4). view(0,0). view(0,2).", "start")
    for optimal in (False, True):
        found = settled(
            experience, ["places = 1", "same(0,0)", "pending(0,2)", "genus>0"], optimal=optimal
        )
        assert [answer.holds for answer in found.each] == ["all", "all", "all", "none"]
    assert found.kind == "best so far"


def test_the_same_twice(topomap):
    words = ["same(3,12)", "planar", "paths < 9"]
    instance = ROOT / "instances/grid-3x3-snake.lp"
    one, other = (topomap("ask", instance, *words, "--json").stdout for _ in range(2))
    assert one == other
    again = json.loads(topomap("ask", instance, *words, *words, "--json").stdout)["statements"]
    assert again[:3] == again[3:] == json.loads(one)["statements"]


@pytest.mark.long
def test_a_long_exploration_goes_through_the_phases():
    experience = read(ROOT / "instances/manhattan-tour88-signs30.lp")
    query = Query(frozenset(["planar", "closed", "perpendicular"]))
    (found,) = hypotheses(experience, query, Watch())
    whole = {found.at: Hypothesis(plain(experience), found.at)}
    draw = random.Random("manhattan")
    texts, tests = zip(*(statement(draw, experience) for _ in range(60)), strict=True)
    demand(settled(experience, texts, query), experience, tests, whole, sorted(query.parts))
