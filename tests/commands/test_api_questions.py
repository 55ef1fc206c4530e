"""The functions of ``topomap`` that answer questions: they say what the commands say."""

import json
import threading

import pytest
import topomap
import topomap.api
from conftest import ROOT
from topomap.api.explore import candidates, check_proofs
from topomap.cli import main
from topomap.runtime.errors import InputError
from topomap.solver.programs import forget

SNAKE = "instances/grid-3x3-snake.lp"
LARGER = "instances/grid-4x4-snake.lp"
LARGE = "instances/manhattan-tour40-signs30.lp"
NO_MAP = "instances/manhattan-tour20.lp"
SOON = 0.001  # seconds, in which nothing is settled


@pytest.fixture
def told(capsys, monkeypatch):
    """What a command says as JSON, and its exit status; both it and what is asked before begin
    with a solver that has learnt nothing, as which maps are found first depends on that."""
    monkeypatch.chdir(ROOT)
    forget()

    def told(*arguments):
        forget()
        status = main([*map(str, arguments), "--json"])
        return json.loads(capsys.readouterr().out), status

    return told


@pytest.fixture
def seen():
    return lambda instance: topomap.read(ROOT / instance)


def same(answer, command, instance):
    """Whether an answer is a command's."""
    ours = {"format": 1, "instance": instance, **answer.document()}
    ours |= {"complete": answer.complete, "fault": answer.fault}
    return json.loads(json.dumps(ours)) == command


@pytest.mark.slow
def test_replies_tell_what_they_come_to(seen):
    snake = seen(SNAKE)
    asked = topomap.ask(snake, "planar", "same(3,12)")
    assert repr(asked) == "<StatementAnswers: planar: some; same(3,12): none>"
    explained = topomap.explain(snake, "same(3,12)")
    assert repr(explained) == f"<Explained: {str(explained).splitlines()[0]}>"
    cut = topomap.explain(seen(LARGE), "same(3,12)", timeout=SOON)
    assert repr(cut) == "<Explained: same(3,12): not settled, partial: timeout>"


def test_the_classes_of_replies_can_be_imported():
    assert dir(topomap.api) == sorted(topomap.api.__all__)
    for name in topomap.api.__all__:
        assert isinstance(getattr(topomap.api, name), type)
    with pytest.raises(AttributeError, match="no attribute 'fly'"):
        _ = topomap.api.fly


def in_a_thread(work):
    """What some work gives, in a thread that is not the main one."""
    found, faults = [], []

    def run():
        try:
            found.append(work())
        except BaseException as fault:
            faults.append(fault)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert not faults, faults
    return found[0]


# Statements


@pytest.mark.parametrize(
    ("options", "parts"),
    [
        ([], {}),
        (["--optimal"], {"optimal": True}),
        (["--planar", "--horizon", "14"], {"planar": True, "horizon": 14}),
        (["--minimal"], {"minimal": True}),
    ],
    ids=["all", "optimal", "parts", "best"],
)
def test_ask_is_the_command(told, seen, options, parts):
    statements = "same(3,12)", "places < 12", "not planar", "linked(3,2,12,0)"
    answers = topomap.ask(seen(SNAKE), *statements, **parts)
    command, status = told("ask", SNAKE, *statements, *options)
    assert same(answers, command, SNAKE)
    assert (status == 0) == answers.has_maps
    assert [one.statement for one in answers] == list(statements)
    for one, other in zip(answers, command["statements"], strict=True):
        assert one.holds == other["holds"]
        for ours, theirs in (one.witness, other["witness"]), (one.counter, other["counter"]):
            assert (ours and ours.document()) == theirs
    assert {one.holds for one in answers} <= {"all", "some", "none"}
    assert answers.kind == command["kind"]
    assert list(answers.cost) == command["cost"]


def test_ask_without_a_map(told, seen):
    answers = topomap.ask(seen(NO_MAP), "planar", "not planar", closed=True)
    assert same(answers, told("ask", NO_MAP, "planar", "not planar", "--closed")[0], NO_MAP)
    assert (answers.has_maps, answers.complete, answers.kind) == (False, True, "consistent")
    assert [one.holds for one in answers] == ["none", "none"]
    assert str(answers) == "no map is consistent with it"


def test_ask_that_is_cut_says_so(seen):
    answers = topomap.ask(seen(LARGE), "planar", "genus < 1", optimal=True, timeout=SOON)
    assert (answers.complete, answers.fault, answers.has_maps) == (False, "timeout", None)
    assert [one.holds for one in answers] == ["not settled"] * 2
    assert answers.kind == "not settled"
    assert all(one.witness is None and one.counter is None for one in answers)
    assert str(answers).endswith("partial: timeout")


def test_what_ask_refuses(seen):
    with pytest.raises(ValueError, match=r"'planer' is not one of the parts .*did you mean planar"):
        topomap.ask(seen(SNAKE), "planar", planer=True)
    with pytest.raises(ValueError, match="a statement is wanted"):
        topomap.ask(seen(SNAKE))
    with pytest.raises(ValueError, match="bound=0"):
        topomap.ask(seen(SNAKE), "planar", bound=0)
    with pytest.raises(InputError, match="step 40: the experience has 16 steps"):
        topomap.ask(seen(SNAKE), "same(3,40)")


# Reasons


@pytest.mark.slow
@pytest.mark.parametrize(
    ("statement", "options", "parts"),
    [
        ("same(3,12)", [], {}),
        ("not same(0,16)", ["--planar", "--horizon", "16"], {"planar": True, "horizon": 16}),
        ("planar", ["--bound", "9"], {"bound": 9}),
        (None, ["--closed"], {"closed": True}),
        (None, ["--bound", "3"], {"bound": 3}),
    ],
)
def test_explain_is_the_command(told, seen, statement, options, parts):
    asked = [statement] if statement else []
    answer = topomap.explain(seen(SNAKE), *asked, **parts)
    command, status = told("explain", SNAKE, *asked, *options)
    assert same(answer, command, SNAKE)
    assert answer.verdict == command["verdict"]
    assert (status == 1) == (answer.verdict in ("open", "map"))
    assert [one.name for one in answer.reasons] == [one["reason"] for one in command["reasons"]]
    for ours, theirs in (answer.witness, "witness"), (answer.counter, "counter"):
        at = [[step, *dstate] for step, dstate in enumerate(ours.at)] if ours else []
        assert at == command[theirs]


def test_explain_that_is_cut_says_so(seen):
    answer = topomap.explain(seen(LARGE), "planar", timeout=SOON)
    assert (answer.complete, answer.fault, answer.verdict) == (False, "timeout", "not settled")
    assert (answer.reasons, answer.minimal, answer.witness, answer.counter) == (
        [],
        False,
        None,
        None,
    )
    assert str(answer) == "planar: not settled\npartial: timeout"


def test_what_explain_refuses(seen):
    with pytest.raises(ValueError, match="'minimal' is not one of the parts planar, euler, closed"):
        topomap.explain(seen(SNAKE), "planar", minimal=True)
    with pytest.raises(ValueError, match="horizon=-1"):
        topomap.explain(seen(SNAKE), "planar", horizon=-1)
    with pytest.raises(InputError, match="no such word"):
        topomap.explain(seen(SNAKE), "round")


# Where to go next


@pytest.mark.parametrize(
    ("options", "arguments"),
    [
        ([], {}),
        (["--bound", "16"], {"bound": 16}),
        (["--marker", "--steps", "3"], {"marker": True, "steps": 3}),
        (["--among", "closed", "--planar"], {"among": "closed", "planar": True}),
        (["--horizon", "8"], {"horizon": 8}),
    ],
    ids=["optimal", "bound", "marker", "closed", "horizon"],
)
def test_explore_is_the_command(told, seen, options, arguments):
    walk = topomap.explore(seen(SNAKE), **arguments)
    command, status = told("explore", SNAKE, *options)
    assert same(walk, command, SNAKE)
    assert walk.kind == (command["kind"] or "not settled")
    assert list(walk.turns) == command["turns"]
    assert (walk.drop, walk.left, walk.proved) == tuple(
        command[k] for k in ("drop", "left", "proved")
    )
    assert [[[step, *at] for step, at in enumerate(one.at)] for one in walk.maps] == [
        one["at"] for one in command["maps"]
    ]
    assert [one.kind for one in walk.maps] == [one["of"] for one in command["maps"]]
    assert (status == 3) == (walk.fault is not None)


def test_explore_among_maps_that_are_given(seen):
    experience = seen(LARGER)
    whole = topomap.explore(experience, bound=16)
    assert whole.kind == "apart"
    again = topomap.explore(experience, whole.maps)
    assert (again.turns, again.left, again.proved) == (whole.turns, whole.left, whole.proved)
    assert {one.of for one in again.among.each} == {"given"}
    assert again.maps == whole.maps
    alone = topomap.explore(experience, whole.maps[:1])
    assert alone.kind == "not settled"  # others were not looked at
    assert topomap.explore(experience, candidates(experience, bound=16)).turns == whole.turns


def test_maps_of_another_experience_are_refused(seen):
    others = topomap.explore(seen(LARGER), bound=16).maps
    with pytest.raises(InputError, match="among: map 1: 30 steps, but the instance has 16"):
        topomap.explore(seen(SNAKE), others)


def test_proofs_can_be_checked(seen, tmp_path):
    experience = seen(SNAKE)
    walk = topomap.explore(experience)
    assert walk.kind == "bisimilar"
    file = tmp_path / "proof.json"
    file.write_text(json.dumps(walk.proofs()))
    checked = check_proofs(experience, str(file))
    assert (checked.proofs, checked.wrong) == (1, ())
    proofs = walk.proofs()
    proofs["proofs"][0]["related"] = proofs["proofs"][0]["related"][1:]
    file.write_text(json.dumps(proofs))
    assert len(check_proofs(experience, str(file)).wrong) == 1


def test_explore_without_a_map(told, seen):
    walk = topomap.explore(seen(NO_MAP), "closed")
    command, status = told("explore", NO_MAP, "--among", "closed")
    assert same(walk, command, NO_MAP)
    assert (walk.kind, walk.complete, walk.maps, walk.turns, status) == ("no map", True, [], (), 1)


def test_explore_that_is_cut_says_so(seen):
    walk = topomap.explore(seen(LARGE), timeout=SOON)
    assert (walk.complete, walk.fault, walk.kind) == (False, "timeout", "not settled")
    assert (walk.maps, walk.turns, walk.left, walk.proved) == ([], (), None, False)
    assert str(walk) == "no map found yet; partial: timeout"


def test_what_explore_refuses(seen):
    with pytest.raises(ValueError, match="'closed' is not one of the parts planar, perpendicular"):
        topomap.explore(seen(SNAKE), closed=True)
    with pytest.raises(ValueError, match="steps=0"):
        topomap.explore(seen(SNAKE), steps=0)
    with pytest.raises(InputError, match="no such file"):
        topomap.explore(seen(SNAKE), "optimum")


# A follower


def steps_of(experience):
    """What a follower is given of an experience: the views, turns and landmarks."""
    turns = [None, *experience.turns]
    return zip(map(sorted, experience.views), turns, map(sorted, experience.landmarks), strict=True)


@pytest.mark.parametrize("planar", [False, True], ids=["all", "planar"])
def test_a_follower_is_the_command(capsys, monkeypatch, seen, planar):
    monkeypatch.chdir(ROOT)
    assert main(["follow", SNAKE, "--no-wait", "--json", *["--planar"] * planar]) == 0
    lines = list(map(json.loads, capsys.readouterr().out.splitlines()))
    follower = topomap.follow(4, planar=planar)
    certain = set()
    for (view, turn, landmarks), line in zip(steps_of(seen(SNAKE)), lines, strict=True):
        status = follower.step(view, turn, landmarks)
        assert line.pop("seconds") >= 0
        ours = {"format": 1, **status.document(), "complete": status.complete, "fault": None}
        assert json.loads(json.dumps(ours)) == line
        assert (status.hypotheses, status.exact) == (line["hypotheses"], line["exact"])
        assert len(status.best) == line["best"]["count"]
        assert (status.kind, list(status.cost)) == (line["best"]["kind"], line["best"]["cost"])
        assert (status.next and list(status.next.turns)) == (line["next"] and line["next"]["turns"])
        certain |= {tuple(pair) for pair in line["certain"]["same"]}
        assert status.certain.same == certain
    best = topomap.solve(seen(SNAKE), optimal=True, planar=planar)
    assert status.best == sorted(best, key=lambda one: one.at)


def test_steps_are_taken_back(seen):
    told = list(steps_of(seen(SNAKE)))
    follower, known = topomap.follow(4), []
    for step in told[:8]:
        known.append(follower.step(*step).answer)
    for steps in (1, 3):
        status = follower.undo(steps)
        assert status.answer.status == known[status.step].status
        assert status.answer.certain == known[status.step].certain
    assert status.step == 3
    assert follower.status().answer == status.answer
    for step in told[4:8]:
        status = follower.step(*step)
    assert status.answer.status == known[7].status


def test_what_a_follower_refuses_changes_nothing():
    follower = topomap.follow(4)
    with pytest.raises(ValueError, match="no step yet"):
        follower.status()
    with pytest.raises(ValueError, match="step 0: there is a turn"):
        follower.step([0, 1], 1)
    follower.step([0, 1])
    before = follower.record
    for step, fault in (
        (([0, 2],), "turn is missing"),
        (([0, 2], 3), "step 1: turn 3: no gateway there after step 0"),
        (([0, 7], 1), "slot 7 is not in 0..3"),
        (([2], 1), "the view lacks slot 0"),
        (([0], 1, ["X"]), "is not a ground term|ground"),
    ):
        with pytest.raises(ValueError, match=fault):
            follower.step(*step)
        assert follower.record == before
    with pytest.raises(ValueError, match="undo of 1 step"):
        follower.undo()
    assert follower.status().step == 0
    with pytest.raises(ValueError, match=r"slots\(3\): K must be even"):
        topomap.follow(3)
    with pytest.raises(ValueError, match="count_limit=0"):
        topomap.follow(4, count_limit=0)


def test_a_follower_that_is_cut_says_so(seen):
    follower = topomap.follow(4, timeout=SOON)
    for step in steps_of(seen(LARGER)):
        status = follower.step(*step)
    assert (status.complete, status.fault) == (False, "timeout")
    assert status.hypotheses is None
    assert status.next is None
    assert "partial: timeout" in repr(status)


# From any thread


@pytest.mark.parametrize("question", ["ask", "explain", "explore", "follow"])
def test_from_a_thread(seen, question):
    experience = seen(SNAKE)
    work = {
        "ask": lambda: topomap.ask(experience, "planar").document(),
        "explain": lambda: topomap.explain(experience, "same(3,12)").document(),
        "explore": lambda: topomap.explore(experience).document(),
        "follow": lambda: topomap.follow(4).step([0, 1]).document(),
    }[question]
    assert in_a_thread(work) == work()
