"""What a user of plain clingo may rely on in each file of encodings/."""

import json
import os
import re
import subprocess
from itertools import combinations

import pytest
from clingo import ast
from conftest import BIN, ENCODINGS, PARTS, ROOT, answers, forms, run
from oracles.rule_mutation import named_files, statements
from topomap.model.facts import read
from topomap.model.vocabulary import PARTS as DRIVER_PARTS
from topomap.model.vocabulary import STATED as STATED_PARTS
from topomap.solver.programs import FORMS

FACTS = read(ROOT / "instances/grid-3x3-snake.lp").facts()
ALL = (*PARTS, "bound", "minimal", "genus", "exceptions", "no_path_axiom")
FURTHER = ("explore", "unseen", "bisimilar")  # of maps, and not parts of the theory
STATED = [file for file in named_files(ENCODINGS) if statements(ENCODINGS, file)]
in_every_form = pytest.mark.parametrize("form", FORMS)


def test_these_are_all_the_parts():
    names = {form: {path.stem for path in folder.glob("*.lp")} for form, folder in FORMS.items()}
    others = {"input", "check", "noise", "query", "explain", "circumscribe", "online", *FURTHER}
    assert names["work"] == {"topomap", *others, *ALL}
    included = {"told", "path_axiom", "paths", "sides"}
    assert names["paper"] == {"topomap", *included, "bound", *STATED_PARTS}
    assert {*DRIVER_PARTS, "bound"} == set(ALL)


IN_HEAD = re.compile(r"^%     ((?:clingo|topomap) (?:.*\\\n%)*.*)$", re.M)
# query.lp's call is of two lines (test_ask.py), and phases/lines.lp needs facts of another call.
HEADS = [
    (file, call.replace("\n%", "\n"))
    for file in STATED
    if file not in ("query", "phases/lines")
    for call in IN_HEAD.findall((ENCODINGS / f"{file}.lp").read_text())
]


@pytest.mark.parametrize(("file", "call"), HEADS, ids=[file for file, _ in HEADS])
def test_the_call_in_a_head_has_an_answer(file, call, tmp_path):
    """And clingo has no message for it."""
    maps = tmp_path / "map.lp"
    (at, *_) = answers([], FACTS)
    maps.write_text(" ".join(f"at({step},{p},{s})." for step, (p, s) in enumerate(at)))
    files = {"INSTANCE": "instances/grid-3x3-snake.lp", "MAP": str(maps)}
    words = re.sub(r"\[.*?\]", "", call)
    for name, path in files.items():
        words = re.sub(rf"\b{name}\b", path, words)
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {words}"],
        env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"},
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode in (10, 30), done.stderr
    assert "Answer: 1" in done.stdout
    assert "info:" not in done.stderr


def test_heads_have_calls():
    assert {"input", "check", "noise", "explain", "explore", "topomap"} < {
        file for file, _ in HEADS
    }


def given(parts):
    """The constant without which bound.lp gives no answer."""
    return ["-c", "places=16"] if "bound" in parts else []


@in_every_form
@pytest.mark.parametrize("parts", [(), *combinations(ALL, 1), *combinations(ALL, 2), ALL])
def test_parts_load_alone_and_together_without_messages(parts, form):
    parts = [part for part in parts if form in forms(part)]
    if form == "paper" and {"perpendicular", "no_path_axiom"} <= {*parts}:
        parts.remove("perpendicular")
    assert answers(parts, FACTS, *given(parts), encoding=form)


@in_every_form
def test_files_load_in_any_order_from_anywhere(form):
    files = [FORMS[form] / f"{name}.lp" for name in ("planar", "closed", "topomap")]
    instance = ROOT / "instances/grid-3x3-snake.lp"
    for order in ([instance, *files], [*reversed(files), instance]):
        done = run("clingo", *order, "0", "-q")
        assert "Models       : 3" in done.stdout.splitlines()
        assert not done.stderr


@pytest.mark.parametrize(
    ("program", "arguments", "status"),
    [("a.", [], 30), ("{a}.", ["1"], 10), (":- not a. {a}. :- a.", [], 20), ("a :-", [], 65)],
)
def test_clingo_is_the_real_one(tmp_path, program, arguments, status):
    file = tmp_path / "program.lp"
    file.write_text(program)
    done = run("clingo", file, *arguments)
    assert done.returncode == status
    assert done.stdout.startswith("clingo version 5.")
    assert json.loads(run("clingo", "--outf=2", "--stats", file).stdout or "{}")["Solver"]


@in_every_form
def test_a_start_without_steps_has_one_map(form):
    assert answers(["planar"], "slots(4). view(0,0).", encoding=form) == {((0, 0),)}


@pytest.mark.parametrize("file", STATED)
def test_each_file_says_what_it_is(file):
    """Each that does not only include others."""
    path = ENCODINGS / f"{file}.lp"
    head = re.match(r"(%.*\n)+", path.read_text()).group()
    assert head.startswith(f"% {path.name} -- ")
    assert re.search(r"^% Input", head, re.MULTILINE)
    assert "ource:" in head


AGGREGATES = {
    "explore": [
        "{ remains(M,N) }",
        "I = #sum { G,M: counts(M,G) }",
        "{ gone(G) }",
        "I < #sum { G,N: remains(M,N), counts(N,G); 1,gone,G: gone(G) }",
    ],
    "explore/walk": ["1 >= { go(I,S): turns(S) }", "1 >= { drop(I): I = (0..(n-1)) }"],
    "bound": ["B < #count { P: new(P) }"],
    "input": ["M = #max { T: has_turn(T) }"],
    "query": [
        "N = #count { S: has_axis(T,S) }",
        "N = #count { S: view(T,S) }",
        "I = #count { B: may_name(B), B < A }",
        "N = #max { M: ask(number(exception,M)); M: ask(least(exception,M)); "
        "M: ask(most(exception,M)) }",
    ],
    "noise": [
        "1 > #sum { noise_with_tolerance: tolerant }",
        "noise >= { wrong(T): step(T) }",
        "{ misread(T,gateway(S)) }",
        "{ misread(T,landmark(L)) }",
    ],
    "online/bound": ["places < #count { P: upto(t,P), new(P) }"],
    "online/costs": ["N = #count { S: view(t,S) }", "N = #count { X: axis(t,S,X) }"],
    "online/path_axiom": [
        "{ joined(A,t): upto(t,A), run(A), A < t }",
        "{ against(t) }",
    ],
    "online/places": ["1 = { at(t,P,S): candidate(P,t,S) }"],
    "paper/bound": ["0 > #sum { (places+0): paper; -1: not paper; -1,P: place(P) }"],
    "paper/topomap": ["1 = { at(T,P,S): alike(T,P,S) }"],
    "paper/told": [
        "0 < #sum { 1,marker: drop(_); -with_marker,marker: drop(_); "
        "1,marker: drop(_,_); -with_marker,marker: drop(_,_); "
        "1,logs: start(_); -with_logs,logs: start(_); "
        "1,logs: look(_); -with_logs,logs: look(_); "
        "1,compass: compass(_,_); -with_compass,compass: compass(_,_); "
        "1,odometry: shift(_,_,_); -with_odometry,odometry: shift(_,_,_); "
        "1,lengths: length(_,_); -with_lengths,lengths: length(_,_); "
        "1,closures: same(_,_); -with_closures,closures: same(_,_); "
        "1,closures: apart(_,_); -with_closures,closures: apart(_,_); "
        "1,straight: straight(_,_,_); -with_straight,straight: straight(_,_,_); "
        "1,bearings: 0 < tolerance; -with_tolerance,bearings: 0 < tolerance }"
    ],
    "paper/perpendicular": [
        "1 > #sum { 1: paper, not no_path_axiom; with_path_axiom: no_path_axiom }"
    ],
    "paper/beyond/straight": [
        "1 > #sum { 1: paper, not along(_,_,_,_); with_sides: along(_,_,_,_) }",
        "N = #min { R: R = S; R: pair(P,S,R) }",
        "1 = #count { here: pair(T,S,R); there: pair(P,X,Y) }",
    ],
    "paper/beyond/tolerance": [
        "I = #count { R: view(T,R), R < S }",
        "M = #count { R: view(T,R) }",
        "1 = #count { here: opposite(T,S,R); there: opposite(P,X,Y) }",
    ],
    "theory/experience": [
        "I = #count { R: view(T,R), R < S }",
        "K = #count { S: view(T,S) }",
    ],
    "theory/places": [
        "1 = { at(T,P,S): candidate(P,T,S), not excluded(T,P,S), not tolerant; "
        "at(T,P,S): candidate(P,T,I), numbered(P,S,I), not barred(P,T,I); "
        "at(T,P,0): uneven(P,T) }"
    ],
    "planar": ["1 != { candidate(Q,(T-1),X): not excluded(Q,Q,0) }"],
    "phases/counts": [
        "N = #count { T: pass(A,T,S,D), four_gateways(T) }",
        "L = #count { C: passes_four(C) }",
    ],
    "phases/ends": [
        "I = #sum { N,R: digit(T,S,R,N) }",
        "N = #count { S: kind(T,S,I) }",
        "0 != #sum { N,T,new: new(T), kind_count(T,I,N); -1,T,out: fresh(T), move(T,S), "
        "kind((T-1),S,I); -1,T,in: fresh(T), kind(T,0,I) }",
    ],
    "phases/lines": [
        "{ one_place(P,T,S) }",
        "{ joined(A,B) }",
        "{ chosen_to_meet(A,B) }",
        "{ against(A) }",
        "{ across(T,N,A) }",
    ],
    "phases/runs": ["{ touch(A,B) }", "{ crossing(A,B) }"],
}


@pytest.mark.parametrize("file", [file for file in STATED if file != "check"])
def test_no_body_weighs_or_counts_derived_atoms(file):
    """clasp miscounts on such bodies (docs/clasp.md): bound.lp counts new/1 (place/1 in paper/)
    alone, each atom of which is one chosen atom; input.lp takes the largest of facts; the choices
    in places.lp and noise.lp are of distinct atoms; those in runs.lp and lines.lp have no bound;
    query.lp, online/costs.lp, planar.lp, phases/counts.lp, experience.lp and, in paper/beyond/,
    straight.lp and tolerance.lp count facts; explore.lp sums facts, and atoms each of which is
    chosen; online/bound.lp counts new/1 as bound.lp does; told.lp and others sum a constant, and
    clingo leaves that out; ends.lp is solved with --eq=0. Of check.lp nothing reaches clasp
    (test_check.py)."""
    aggregates = []

    class Finder(ast.Transformer):
        def visit_BodyAggregate(self, node):
            aggregates.append(str(node))
            return node

        visit_Aggregate = visit_HeadAggregate = visit_BodyAggregate

        def visit_Script(self, node):
            raise AssertionError("a script")

    for statement in statements(ENCODINGS, file):
        Finder().visit(statement)
    assert aggregates == AGGREGATES.get(file, [])
