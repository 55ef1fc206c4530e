"""Rule mutation: which mutants are made, what makes ``make mutate`` fail, and samples of it."""

import os
import subprocess
import sys
import time
from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import pytest
from conftest import ENCODINGS, ROOT
from oracles import rule_mutation as mutate
from oracles.known_answers import (
    Query,
    biting,
    check,
    circumscription,
    demands,
    ends,
    faults,
    following,
    given_up,
    off_or_bent,
    phases,
    queries,
    shown,
    sizes,
    squares,
    theory,
)

MANY = 1500  # queries for a mutant, where only some mutants are tried
PORTIONS = 10  # of the mutants that are tried one after the other: each ends in minutes

RULES = """
p(X) :- q(X,1), not r(X).
:- p(X), X > 1, not q(X,Y) : r(Y).
:- p(X), q(X) : p(X).
{ s(X) : q(X,_) } = 2.
#minimize { 3@1,X : s(X) }.
"""
MUTANTS = {
    "p(X) :- q(X,1); not r(X).": {
        "remove": "",
        "drop q(X,1)": "p(X) :- not r(X).",
        "q(X,1) -> not q(X,1)": "p(X) :- not q(X,1); not r(X).",
        "q(X,1) -> q(X,2)": "p(X) :- q(X,2); not r(X).",
        "q(X,1) -> q(X,0)": "p(X) :- q(X,0); not r(X).",
        "drop not r(X)": "p(X) :- q(X,1).",
        "not r(X) -> r(X)": "p(X) :- q(X,1); r(X).",
    },
    "#false :- p(X); X > 1; not q(X,Y): r(Y).": {
        "remove": "",
        "drop p(X)": "#false :- X > 1; not q(X,Y): r(Y).",
        "p(X) -> not p(X)": "#false :- not p(X); X > 1; not q(X,Y): r(Y).",
        "drop X > 1": "#false :- p(X); not q(X,Y): r(Y).",
        "X > 1 -> X <= 1": "#false :- p(X); X <= 1; not q(X,Y): r(Y).",
        "X > 1 -> X > 2": "#false :- p(X); X > 2; not q(X,Y): r(Y).",
        "X > 1 -> X > 0": "#false :- p(X); X > 0; not q(X,Y): r(Y).",
        "drop not q(X,Y): r(Y)": "#false :- p(X); X > 1.",
        "not q(X,Y) -> q(X,Y)": "#false :- p(X); X > 1; q(X,Y): r(Y).",
        "drop r(Y)": "#false :- p(X); X > 1; not q(X,Y).",
        "r(Y) -> not r(Y)": "#false :- p(X); X > 1; not q(X,Y): not r(Y).",
    },
    "#false :- p(X); q(X): p(X).": {
        "remove": "",
        "drop p(X)": "#false :- q(X): p(X).",
        "p(X) -> not p(X)": "#false :- not p(X); q(X): p(X).",
        "drop q(X): p(X)": "#false :- p(X).",
        "q(X) -> not q(X)": "#false :- p(X); not q(X): p(X).",
        "drop p(X) (2)": "#false :- p(X); q(X).",
        "p(X) -> not p(X) (2)": "#false :- p(X); q(X): not p(X).",
    },
    "2 = { s(X): q(X,_) }.": {
        "remove": "",
        "= 2 -> = 3": "3 = { s(X): q(X,_) }.",
        "= 2 -> = 1": "1 = { s(X): q(X,_) }.",
        "drop q(X,_)": "2 = { s(X) }.",
        "q(X,_) -> not q(X,_)": "2 = { s(X): not q(X,_) }.",
    },
    ":~ s(X). [3@1,X]": {
        "remove": "",
        "weight 3 -> 4": ":~ s(X). [4@1,X]",
        "weight 3 -> 2": ":~ s(X). [2@1,X]",
        "priority 1 -> 2": ":~ s(X). [3@2,X]",
        "priority 1 -> 0": ":~ s(X). [3@0,X]",
        "drop s(X)": ":~ . [3@1,X]",
        "s(X) -> not s(X)": ":~ not s(X). [3@1,X]",
    },
}

# A program with mutants that are killed, refused and endless, and an equivalent one.
COUNTER = "% Count.\nn(0).\nn(X+1) :- n(X), X < limit.\n#show n/1.\n"
ASKED = [
    Query(("counter",), "", shown("n(0)", "n(1)"), ("-c", "limit=1")),
]
EQUIVALENT = ("counter", "#show n/1.", "remove")
KILLED = ("counter", "n(0).", "n(0) -> n(1)")
STALE = ("counter", "n(7).", "remove")


def listing(*keys):
    """The text that lists these mutants as equivalent."""
    return "\n".join(
        f"[[equivalent]]\nfile = '{file}'\nrule = '{rule}'\nchanges = ['{change}']\nreason = 'R.'\n"
        for file, rule, change in keys
    )


@pytest.fixture
def mutated(tmp_path, monkeypatch, capsys):
    """A function that runs the command on COUNTER; its status, output, messages and report."""
    monkeypatch.setattr(mutate, "SECONDS", 0.2)
    report, listed, folder = (tmp_path / name for name in ("report.md", "listed.toml", "folder"))
    folder.mkdir()
    (folder / "counter.lp").write_text(COUNTER)

    def run(text, *arguments):
        listed.write_text(text)
        files = ["--listed", str(listed), "--report", str(report)]
        status = mutate.main([*files, *arguments], folder, lambda: ASKED, list)
        written = report.read_text() if report.exists() else None
        return status, *capsys.readouterr(), written

    return run


def test_these_mutants_are_made(tmp_path):
    (tmp_path / "rules.lp").write_text("% A comment.\n" + RULES)
    made = {rule: {} for rule in MUTANTS}
    for mutant in mutate.mutants(tmp_path, "rules"):
        made[mutant.rule][mutant.change] = mutant.text
    assert made == MUTANTS


@pytest.mark.slow
def test_all_is_well_if_only_listed_mutants_survive(mutated):
    status, out, _, report = mutated(listing(EQUIVALENT))
    assert status == 0
    assert out == "11 mutants: 1 survived, 7 killed, 2 refused, 1 endless, 0 larger, 0 untried\n"
    assert (
        "| `counter.lp` | 3 | 2 | 2 | 4 | 11 | 0 | 7 | 2 | 1 | 0 | 0 | 1 |" in report.splitlines()
    )
    assert "- `remove`: R." in report.splitlines()
    assert mutated(listing(EQUIVALENT), "-j", "3")[3] == report


@pytest.mark.slow
def test_what_was_tried_is_not_tried_again(mutated, tmp_path, monkeypatch):
    """Unless the encoding, or a query, is another one."""
    known = tmp_path / "known.txt"
    mutated(listing(EQUIVALENT), "--known", str(known), "counter", "--sample", "4")
    assert len(known.read_text().splitlines()) == 4
    _, out, _, report = mutated(listing(EQUIVALENT), "--known", str(known))
    assert out == mutated(listing(EQUIVALENT))[1]
    tried, fates = [], mutate.fates

    def note(folder, chosen, *more):
        for one in fates(folder, chosen, *more):
            tried.append(one.mutant)
            yield one

    monkeypatch.setattr(mutate, "fates", note)
    assert mutated(listing(EQUIVALENT), "--known", str(known))[3] == report
    assert not tried
    (tmp_path / "folder/counter.lp").write_text(COUNTER.replace("n(X)", "n(X), X >= 0"))
    mutated(listing(EQUIVALENT), "--known", str(known))
    assert len(tried) > 11


def test_the_query_that_settled_a_mutant_comes_first_the_next_time(mutated, tmp_path, monkeypatch):
    """And one that settled others comes before one that settled nothing."""
    other = Query(("counter",), "", shown("n(0)", "n(1)", "n(2)"), ("-c", "limit=2"))
    known = tmp_path / "known.txt"
    mutated(listing(EQUIVALENT), "--known", str(known))
    settled = Counter(line.split()[-1] for line in known.read_text().splitlines())
    first, second = map(mutate.name_of, (ASKED[0], other))
    assert settled == {first: 9, "-": 1, str(mutate.QUERIES): 1}
    lines = known.read_text().replace(first, second, 1).splitlines()
    stale = [" ".join([key, "stale", *rest]) for key, _, *rest in map(str.split, lines)]
    known.write_text("\n".join([*stale, ""]))
    log, suffer = tmp_path / "log", mutate.suffer

    def note(programs, whole, asked):
        with log.open("a") as file:
            file.write(f"{mutate.name_of(asked[0])}\n")
        return suffer(programs, whole, asked)

    monkeypatch.setattr(mutate, "suffer", note)
    monkeypatch.setitem(globals(), "ASKED", [other, ASKED[0]])
    mutated(listing(EQUIVALENT), "--known", str(known))
    assert Counter(log.read_text().split()) == {first: 10, second: 1}
    # A further query is only asked where no other one settled the mutant: of the survivor and of
    # the endless one.
    log.write_text("")
    further = Query(("counter",), "m(5).", shown("n(0)", "n(1)"), ("-c", "limit=1"))
    monkeypatch.setitem(globals(), "ASKED", [further, *ASKED])
    mutated(listing(EQUIVALENT), "--known", str(known))
    assert len(log.read_text().split()) == 2


def test_what_settled_others_and_what_a_rule_is_about_take_turns():
    """With what loads other files, and what comes at random."""
    rule, of_rule, of_file = "a(T) :- shifted(T).", Query(("f",), "w.", {}), Query(("f",), "v.", {})
    among = ["shifted(T) :- shift(T,X).", rule, "b(T) :- length(T,D)."]
    asked = [Query(("f",), f"view({n}).", {}) for n in range(9)]
    asked += [of_file, Query(("f",), "length(1,2).", {}), Query(("f",), "shift(1,2).", {}), of_rule]
    mutant = mutate.Mutant("f", rule, "drop", "drop", 1, "a(T).")
    others = replace(mutant, change="remove"), replace(mutant, rule=among[2])
    settled = mutate.name_of(of_rule), mutate.name_of(of_file)
    asked.append(Query(("f", "g"), "length(1,2).", {}))
    order = mutate.Order(asked, dict(zip(others, settled, strict=True)))
    loading = dict.fromkeys(range(len(asked)), 2)
    assert order.of(mutant, loading, among)[:6] == [12, 11, 0, 9, 13, 1]
    assert sorted(order.of(mutant, loading, among)) == [*loading]


def test_a_listed_survivor_is_asked_more_as_soon_as_it_may_be(mutated, tmp_path, monkeypatch):
    """And not before."""
    more = Query(("counter",), "m(5).", shown("n(0)", "n(1)"), ("-c", "limit=1"))
    monkeypatch.setitem(globals(), "ASKED", [*ASKED, more])
    known = tmp_path / "known.txt"
    few = ("--queries", "1", "--known", str(known))
    status, *_, report = mutated(listing(EQUIVALENT), *few)
    assert status == 0
    assert "at most 1 of the\n2 queries" in report
    mutated(listing(EQUIVALENT), *few)
    assert len(known.read_text().splitlines()) == 11
    status, out, *_ = mutated(listing(EQUIVALENT), "--known", str(known))
    wrong = ["listed, but killed: counter | #show n/1. | remove"]
    assert (status, out.splitlines()[1:]) == (1, wrong)
    lines = known.read_text().splitlines()
    assert len(lines) == 12
    assert lines[-1].split()[2:] == ["killed", mutate.name_of(more)]


def test_a_survivor_that_is_not_listed_is_asked_everything(mutated, tmp_path, monkeypatch):
    """However few the others are asked; and again, as long as it survives."""
    known = tmp_path / "known.txt"
    few = ("--queries", "1", "--known", str(known))
    for lines in 11, 12:
        assert mutated("equivalent = []", *few)[0] == 1
        assert len(known.read_text().splitlines()) == lines
    more = Query(("counter",), "m(5).", shown("n(0)", "n(1)"), ("-c", "limit=1"))
    monkeypatch.setitem(globals(), "ASKED", [*ASKED, more])
    assert mutated("equivalent = []", *few)[0] == 0
    killed = known.read_text().splitlines()[-1].split()[2:]
    assert killed == ["killed", mutate.name_of(more)]
    assert mutated("equivalent = []", "--queries", "1")[0] == 0


def test_minutes_need_a_file_for_what_was_tried(mutated, capsys):
    with pytest.raises(SystemExit) as end:
        mutated(listing(EQUIVALENT), "--minutes", "1")
    assert end.value.code == 2
    assert "--minutes needs --known" in capsys.readouterr().err


def test_what_there_is_no_time_for_is_untried(mutated, tmp_path, monkeypatch):
    """It is in the report, and makes the run fail; the next run goes on."""
    known = tmp_path / "known.txt"
    clock = iter([0, *range(50, 10_000, 50)])
    monkeypatch.setattr(mutate, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    status, out, _, report = mutated(listing(EQUIVALENT), "--known", str(known), "--minutes", "1")
    assert (status, len(known.read_text().splitlines())) == (1, 2)
    first, *faults = out.splitlines()
    assert first.endswith(" 9 untried")
    assert len(faults) == 9
    assert all(fault.startswith("not tried: ") for fault in faults)
    assert "| 9 | 0 |" in report
    monkeypatch.setattr(mutate, "time", time)
    assert mutated(listing(EQUIVALENT), "--known", str(known))[0] == 0
    assert len(known.read_text().splitlines()) == 11


MARKS = """
import sys
from pathlib import Path
from oracles import rule_mutation as mutate
from oracles.known_answers import Query, shown
folder = Path(sys.argv[1])
asked = [Query(("counter", name), "", shown()) for name in "abcdef"]
every = mutate.mutants(folder, "counter")
mark = mutate.marks(folder, every, asked, [])
print(*(mark(one, query) for one in every for query in (mutate.name_of(asked[0]), "100")))
"""


@pytest.mark.slow
def test_what_was_tried_is_known_to_another_process(tmp_path):
    """In any order of its sets."""
    for name in ("counter", *"abcdef"):
        (tmp_path / f"{name}.lp").write_text(COUNTER)
    printed = set()
    for seed in "123":
        call = [sys.executable, "-c", MARKS, str(tmp_path)]
        hashed = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT / "tests")}
        printed.add(subprocess.run(call, env=hashed, capture_output=True, check=True).stdout)
    assert len(printed) == 1
    assert all(printed)


@pytest.mark.slow
def test_a_survivor_that_is_not_listed_is_a_fault(mutated):
    status, out, _, report = mutated("equivalent = []")
    assert status == 1
    assert out.splitlines()[1:] == ["survives, not listed: counter | #show n/1. | remove"]
    assert "- `remove`: **Not listed.**" in report.splitlines()


def test_one_entry_may_list_several_rules(mutated):
    entry = listing(EQUIVALENT).replace("rule = '#show n/1.'", "rule = ['#show n/1.', 'n(0).']")
    status, out, *_ = mutated(entry)
    assert status == 1
    assert out.splitlines()[1:] == ["listed, but killed: counter | n(0). | remove"]


def test_a_listed_mutant_that_is_killed_or_is_none_is_a_fault(mutated):
    status, out, *_ = mutated(listing(EQUIVALENT, KILLED, STALE))
    assert status == 1
    assert out.splitlines()[1:] == [
        "listed, but killed: counter | n(0). | n(0) -> n(1)",
        "listed, but no mutant: counter | n(7). | remove",
    ]


@pytest.mark.slow
def test_a_mutant_that_only_grounds_to_more_is_larger(tmp_path):
    """If its size is measured."""
    (tmp_path / "some.lp").write_text("few(X) :- n(X), X < 1.\n")
    (tmp_path / "paper").mkdir()
    (tmp_path / "paper/other.lp").write_text("few(X) :- n(X), X < 1.\n#show n/1.\n")
    (tmp_path / "topomap.lp").write_text('#include "some.lp".\n#show n/1.\nm :- n(7).\n')
    asked = [
        Query(("paper/other",), "n(0). n(1).", shown("n(0)", "n(1)")),
        Query(("topomap",), "n(0). n(1).", shown("n(0)", "n(1)")),
    ]
    report, listed = tmp_path / "report.md", tmp_path / "listed.toml"
    listed.write_text("equivalent = []")
    files = ["--listed", str(listed), "--report", str(report)]
    assert mutate.main(files, tmp_path, lambda: asked, lambda: asked[1:]) == 1
    rows = report.read_text().splitlines()
    assert "| `some.lp` | 1 | 2 | 2 | 2 | 7 | 3 | 0 | 2 | 0 | 2 | 0 | 0 |" in rows
    assert "| `paper/other.lp` | 2 | 2 | 2 | 2 | 8 | 5 | 1 | 2 | 0 | 0 | 0 | 0 |" in rows


def test_a_sample_is_of_mutants_that_are_not_listed_and_writes_nothing(mutated):
    status, out, _, report = mutated(listing(EQUIVALENT), "--sample", "99")
    assert (status, report) == (0, None)
    assert out.startswith("10 mutants: 0 survived,")


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        ("equivalent = ", (), "listed.toml"),
        ("[[equivalent]]\nfile = 'counter'", (), "listed.toml"),
        ("equivalent = []", ("links",), "links: no such encoding"),
    ],
)
def test_bad_input_is_refused_in_one_line(mutated, text, arguments, message):
    status, out, err, report = mutated(text, *arguments)
    assert (status, out, report) == (2, "", None)
    assert err.startswith("mutate: ")
    assert message in err
    assert err.count("\n") == 1


def test_an_encoding_that_no_query_loads_is_refused(mutated, tmp_path):
    (tmp_path / "folder/other.lp").write_text("a.\n")
    assert mutated(listing(EQUIVALENT))[2].startswith("mutate: other: no query")


def test_an_encoding_that_gives_a_wrong_answer_unchanged_is_refused(mutated, monkeypatch):
    wrong = [Query(("counter",), "", shown("n(0)"), ("-c", "limit=1"))]
    monkeypatch.setitem(globals(), "ASKED", wrong)
    status, out, err, _ = mutated(listing(EQUIVALENT))
    assert (status, out) == (2, "")
    assert err == "mutate: counter: a query has a wrong answer without a change\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    "suite",
    [
        squares,
        circumscription,
        ends,
        demands,
        faults,
        *(
            pytest.param(suite, marks=pytest.mark.long)
            for suite in (theory, phases, check, following, biting, given_up, off_or_bent)
        ),
    ],
)
def test_the_encodings_answer_right(suite):
    """So nothing but its change kills a mutant."""
    programs = {}
    for query in suite():
        if query.files not in programs:
            names = mutate.closure(ENCODINGS, query.files)
            parts = (map(str, mutate.statements(ENCODINGS, name)) for name in names)
            programs[query.files] = mutate.whole_program(parts)
        assert mutate.tried(programs[query.files], query) == "survived", query
    assert programs


@pytest.mark.long
@pytest.mark.parametrize("portion", range(PORTIONS))
def test_no_statement_can_be_removed(portion):
    """Each, except for the listed ones, is missed by some query."""
    reasons = mutate.listed(mutate.LISTED)
    chosen = [
        mutant
        for file in mutate.named_files(ENCODINGS)
        for mutant in mutate.mutants(ENCODINGS, file)
        if mutant.kind == "remove" and mutant.key not in reasons
    ]
    mine = chosen[portion::PORTIONS]
    assert len(mine) > 30
    for mutant, fate, _ in mutate.fates(ENCODINGS, mine, queries(), sizes(), 1, most=MANY):
        assert fate in ("killed", "refused", "larger"), mutant


@pytest.mark.long
def test_a_sample_is_killed(capsys):
    status = mutate.main(["--sample", "100", "--seed", "sample", "--queries", str(MANY)])
    assert status == 0, capsys.readouterr().out
