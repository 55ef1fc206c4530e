"""``topomap report``: the page by itself, and in a browser that shows it."""

import base64
import hashlib
import json
import math
import os
import random
import re
import signal
import subprocess
import time
from collections import Counter
from html import unescape
from html.parser import HTMLParser
from itertools import combinations, product

import pytest
from conftest import BIN, ROOT, answers, plain, run
from matplotlib.path import Path as Outline
from oracles import brute_force as oracle
from oracles.worlds import WORLDS, informed, random_experience
from topomap import cli
from topomap.drawing import shapes, svg
from topomap.drawing.agreement import Agreement
from topomap.drawing.scenes import Scene
from topomap.model import words
from topomap.model.facts import parse, read
from topomap.model.query import Query
from topomap.page.chapter import Chapter
from topomap.page.replay import SHOWN, fate, replay
from topomap.page.report import FOLDER
from topomap.runtime.watch import Watch
from topomap.search.traversal import breadth_first, root
from topomap.worlds.environment import grid

GRID = "instances/grid-3x3-snake.lp"
LARGE = "instances/grid-4x4-snake.lp"
EVIL = "<script>alert(1)</script>\"'&</style><img src=x onerror=alert(2)>"
VOID = {"meta", "input", "br", "img", "link"}


class Page(HTMLParser):
    """The elements of a page, each with its attributes and text, and its tables."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.tables, self.open = [], {}, []
        self.text = text
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        names = [name for name, _ in attributes]
        assert len(names) == len(set(names)), (tag, names)
        element = {"tag": tag, "text": "", **dict(attributes)}
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)
        if tag == "table":
            self.rows = []
        if tag == "tr":
            self.rows.append([])

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        self.handle_endtag(tag)

    def handle_data(self, data):
        for element in self.open:
            element["text"] += data

    def handle_endtag(self, tag):
        element = self.open.pop()
        assert element["tag"] == tag, (element, tag)
        if tag in ("td", "th"):
            self.rows[-1].append(element["text"].strip())
        if tag == "caption":
            self.caption = element["text"]
        if tag == "table":
            self.tables[self.caption] = self.rows

    def all(self, tag):
        return [element for element in self.elements if element["tag"] == tag]


def report(file, *arguments):
    """The status of a call in this process, and the page."""
    status = cli.main(["report", *map(str, arguments), "-o", str(file)])
    return status, Page(file.read_text())


@pytest.fixture(scope="module")
def three(tmp_path_factory):
    """The page of the 3 x 3 grid."""
    file = tmp_path_factory.mktemp("page") / "three.html"
    status, page = report(file, ROOT / GRID)
    assert status == 0
    return file, page


def levels(facts, *parts):
    """The hypotheses after each step, by stock clingo."""
    last = max([0, *map(int, re.findall(r"turn\((\d+)", facts))])
    return [answers(parts, facts, "-c", f"horizon={step}") for step in range(last + 1)]


def figures(seen, at):
    """What a picture says of a hypothesis."""
    scene = Scene(seen.map_of(at), at, "")
    place, slot = at[-1]
    return f"{scene.title.splitlines()[1]}, the agent at place {place}, gateway {slot}"


@pytest.mark.slow
def test_numbers_are_those_of_clingo_and_of_the_paper(three):
    _, page = three
    seen = read(ROOT / GRID)
    name = str(ROOT / GRID)
    rows = page.tables[f"Hypotheses after each step of {name}"][1:]
    without = [len(level) for level in levels(seen.facts())]
    having = [len(level) for level in levels(seen.facts(), "planar")]
    assert [[int(cell) for cell in row] for row in rows] == [
        list(row) for row in zip(range(17), without, having, strict=True)
    ]
    assert (without[-1], having[-1]) == (88, 62)
    log = page.tables[f"Log of {name}"][1:]
    assert [int(row[-1]) for row in log] == without
    turns = {0: "back", 1: "left", 2: "straight on", 3: "right"}
    assert [row[1] for row in log[2:]] == [turns[turn] for turn in seen.turns[1:]]
    refused = page.tables[f"Arrivals tried and refused at each step of {name}"][2:]
    assert [int(row[-1]) for row in refused] == without[1:]
    assert [int(row[1]) for row in refused] == without[:-1]
    (told,) = [e["text"] for e in page.all("p") if "found" in e["text"] and "map" in e["text"]]
    assert told.startswith("2 maps found: optimal.")
    assert len(answers(("closed", "boundary", "minimal"), seen.facts())) == 2


def test_words_of_turns():
    """Seen from the gateway arrived by: on a grid, from west to east, south is right."""
    world = grid(3, 3).map
    place, arrival = world.links[(1, 0), 1]
    assert (place, arrival) == ((1, 1), 3)
    told = {slot: words.direction((slot - arrival) % 4, 4) for slot in range(4)}
    assert told == {0: "left", 1: "straight on", 2: "right", 3: "back"}
    assert words.direction(1, 6) == "left (1 slot clockwise)"
    assert words.direction(4, 6) == "right (4 slots clockwise)"
    assert words.direction(1, 2) == "straight on"
    assert words.listed(range(10), 3) == "0, 1, 2 and 7 more"


DENIED = {  # by which facts what is known besides views refuses an arrival, in order
    "compass": "compass",
    "odometry": "shift",
    "apart": "apart",
    "same": "same",
    "length": "length",
}


def refusals(seen, at, planar, perpendicular, bound):
    """Where the next step may arrive, and the rule that refuses it, from the definitions."""
    before = oracle.Hypothesis(plain(seen), at)
    step = len(at)
    out = before.leaves(step)

    def unlike(place, slot):
        if {(other - slot) % seen.slots for other in seen.views[place]} != set(seen.views[step]):
            return "view"
        if seen.landmarks[place] != seen.landmarks[step]:
            return "landmark"
        return marked((place, slot))

    def marked(arrival):
        if not oracle.marked(plain(seen)[-2], (*at, arrival)):
            return "marker"
        *rest, told = plain(seen)
        for rule, fact in DENIED.items():
            alone = [one for one in told if one[0] in (fact, "drift", "stretch")]
            if alone and oracle.contradicts((*rest, alone), (*at, arrival)):
                return rule
        return None

    def broken(arrival):
        child = (*at, arrival)
        fault = seen.map_of(child).path_axiom_fault()
        if fault:
            return "circular" if "circular" in fault else "twice"
        if planar and not before.one_face(out, arrival):
            return "planarity"
        if perpendicular and not oracle.Hypothesis(plain(seen), child).perpendicular():
            return "perpendicular"
        return None

    if out in before.link:
        return {before.link[out]: unlike(*before.link[out])}
    found = {g: unlike(*g) or broken(g) for g in before.pending() if g != out}
    full = bound is not None and len(before.stars) >= bound
    return found | {(step, 0): marked((step, 0)) or ("bound" if full else None)}


def test_what_is_refused_is_what_the_definitions_refuse(record_property):
    draw = random.Random("refused")
    drawn = (random_experience(draw, 9, marker=number % 2 > 0) for number in range(60))
    more = (informed(random.Random(f"refused {number}"), 8) for number in range(160))
    experiences = [*WORLDS.values(), *drawn, *more]
    rules = Counter()
    for seen in experiences:
        planar, perpendicular = draw.random() < 0.4, draw.random() < 0.3
        bound = draw.choice([None, None, 3, 5])
        parts = ["planar"] * planar + ["perpendicular"] * perpendicular
        query = Query(frozenset(parts), bound)
        steps, fault = replay(seen, query, [], Watch())
        assert fault is None
        level = [((0, 0),)]
        for number, step in enumerate(steps):
            if number:
                tried, ended, foreseen, children = Counter(), Counter(), 0, []
                for at in level:
                    found = refusals(seen, at, planar, perpendicular, bound)
                    tried.update(rule or "" for rule in found.values())
                    kept = [arrival for arrival, rule in found.items() if not rule]
                    children += [(*at, arrival) for arrival in kept]
                    foreseen += len(found) == 1 and (number, 0) not in found
                    if not kept:
                        ended[found.get((number, 0)) or next(iter(found.values()))] += 1
                level = children
                assert step.judged
                assert (step.tried, step.ended, step.foreseen) == (tried, ended, foreseen)
                rules += tried
            assert step.alive == len(level)
            assert len(step.shown) == min(len(level), SHOWN)
            assert set(step.shown) <= set(level)
    assert all(rules[rule] for rule in words.RULES), rules
    record_property("arrivals refused as by definition", sum(rules.values()) - rules[""])


def by_rule(found):
    """Arrivals by the rule that refuses them."""
    rules = {}
    for arrival, rule in sorted(found.items()):
        if rule:
            rules.setdefault(rule, []).append(arrival)
    return rules


def test_what_is_refused_of_each_hypothesis():
    """As the definitions have it, and as the search has it."""
    draws = random.Random("of each")
    drawn = (random_experience(draws, 8, marker=number % 2 > 0) for number in range(20))
    more = (informed(random.Random(f"of each {number}"), 8) for number in range(160))
    some = [*WORLDS.values(), *drawn, *more]
    rules = Counter()
    for seen in some:
        planar, perpendicular = draws.random() < 0.5, draws.random() < 0.5
        bound = draws.choice([None, 3])
        parts = ["planar"] * planar + ["perpendicular"] * perpendicular
        query = Query(frozenset(parts), bound)
        node = root(seen, query)
        for at in [one.dstates for one in breadth_first(node)][:40]:
            children, ended, refused = fate(seen, query, at)
            if len(at) > seen.steps:
                assert (children, ended, refused) == (0, "", {})
                continue
            found = refusals(seen, at, planar, perpendicular, bound)
            assert refused == by_rule(found)
            node.goto(at)
            tried = {divmod(arrival, seen.slots): rule for arrival, rule in node.tried()}
            assert refused == by_rule(tried)
            assert children == sum(rule is None for rule in found.values())
            rules.update(list(refused))
    assert set(rules) == set(words.RULES)


def test_the_page_tells_what_is_refused_of_each_hypothesis(three):
    """Gateways as place.slot; of a place that the step makes there is none on this page."""
    _, page = three
    seen = read(ROOT / GRID)
    best = sorted(answers(("closed", "boundary", "minimal"), seen.facts()))
    shown = [at for step in replay(seen, Query(), best, Watch())[0] for at in step.shown]
    captions = [
        " ".join(e["text"].split())
        for e in page.all("figure")
        if e["class"].startswith("hypothesis")
    ]
    told = 0
    assert len(captions) == len(shown) > 40
    for at, caption in zip(shown, captions, strict=True):
        found = {}
        if len(at) <= seen.steps:
            found = by_rule(refusals(seen, at, False, False, None))
        if not found:
            assert "Refused" not in caption
            continue
        (parts,) = re.findall(r"Refused at the next step: (.*)\.$", caption)
        read_back = {}
        for part in parts.split("; "):
            gateways, _, why = part.partition(": ")
            names = re.findall(r"(\d+)\.(\d+)", gateways)
            read_back[why] = [(int(place), int(slot)) for place, slot in names]
            more = re.findall(r"and (\d+) more", gateways)
            read_back[why] += [None] * sum(map(int, more))
        few = {rule: ends[:6] + [None] * (len(ends) - 6) for rule, ends in found.items()}
        assert read_back == {words.RULES[rule]: ends for rule, ends in few.items()}
        told += 1
    assert told > 10


def test_words_of_what_is_refused():
    many = {"view": [(n, 1) for n in range(9)], "bound": [(12, 0)]}
    assert words.refused(many, 12) == (
        "0.1, 1.1, 2.1, 3.1, 4.1, 5.1 and 3 more: another view is seen there; "
        "a new place: there would be too many places"
    )
    assert words.refused({}, 3) == ""


def test_shown_are_the_beginnings_of_the_best_and_the_cheapest():
    seen = read(ROOT / GRID)
    best = sorted(answers(("closed", "boundary", "minimal"), seen.facts()))
    steps, _ = replay(seen, Query(), best, Watch())
    node = root(seen, Query())
    cost = {node.dstates: node.cost for node in breadth_first(node)}
    for step, found in enumerate(steps):
        begun = list(dict.fromkeys(at[: step + 1] for at in best))
        assert found.shown[: len(begun)] == begun
        level = sorted((cost[at], at) for at in cost if len(at) == step + 1)
        assert {level[0][1]} <= set(found.shown)
        for later in steps[step + 1].shown[:3] if step < seen.steps else []:
            assert later[: step + 1] in found.shown


@pytest.mark.slow
def test_large_steps_are_looked_at_in_part(monkeypatch):
    """Then nothing is counted, but what is shown are hypotheses still."""
    monkeypatch.setattr("topomap.page.replay.MOST", 20)
    monkeypatch.setattr("topomap.page.replay.KEPT", 5)
    seen = read(ROOT / GRID)
    steps, _ = replay(seen, Query(), [], Watch())
    whole = levels(seen.facts())
    first = next(step for step, level in enumerate(whole) if len(level) > 20)
    for number, step in enumerate(steps):
        assert step.alive == (len(whole[number]) if number <= first else None)
        assert step.judged == (0 < number <= first)
        assert step.shown
        assert set(step.shown) <= whole[number]


def clockwise(drawn, world, place):
    """The slots of a place in the order in which their lines leave it, clockwise from above."""
    x, y = drawn.places[place]
    angle = {}
    for slot in world.stars[place]:
        u, v = next(p for p in drawn.lines[place, slot] if p != (x, y))
        angle[slot] = math.atan2(v - y, u - x) % (2 * math.pi)
    return sorted(angle, key=angle.get)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [GRID, pytest.param("instances/manhattan-tour20.lp", marks=pytest.mark.long)]
)
def test_drawings_are_of_the_maps(name):
    seen = read(ROOT / name).cut(12)
    about = Chapter(name, seen, Query(), 2, Watch())
    about.look(60)
    assert not about.faults
    shown = [at for step in about.steps for at in step.shown]
    assert len(about.shapes) >= 0.9 * len(shown)  # some cannot be made legible
    for at in shown:
        if at in about.shapes:
            world, drawn = seen.map_of(at), about.shapes[at]
            assert set(drawn.places) == set(world.stars)
            assert set(drawn.lines) == set(world.gateways())
            crossing = {end for link in drawn.crossing for end in link}
            assert bool(crossing) == bool(world.genus())
            for gateway, line in drawn.lines.items():
                assert line[0] == drawn.places[gateway[0]]
                if gateway in world.links:
                    assert line[-1] == drawn.places[world.links[gateway][0]]
                else:
                    assert math.dist(line[0], line[-1]) < 1.1 * shapes.STUB
            for place, star in world.stars.items():
                order = clockwise(drawn, world, place)
                start = order.index(min(star))
                assert order[start:] + order[:start] == sorted(star)


def test_pictures_tell_the_gateways():
    """A tick each, in their order, and a dot at gateway 0; faces with their numbers."""
    seen = read(ROOT / GRID)
    at = min(answers(("closed", "boundary", "minimal", "planar"), seen.facts()))
    scene = Scene(seen.map_of(at), at, "")
    drawn = shapes.drawing(scene.world, None)
    text = svg.body(scene, drawn, False)
    number = r"-?[\d.]+"
    (ticks,), (dots,) = (
        re.findall(f'class="{kind}" d="([^"]*)"', text) for kind in ("port", "zero")
    )
    found = re.findall(f"M({number}) ({number}) ({number}) ({number})", ticks)
    points = [tuple(map(float, point)) for point in found]
    zeros = {(float(x), float(y)) for x, y in re.findall(f"M({number}) ({number})h0", dots)}
    assert len(points) == len(list(scene.world.gateways()))
    assert len(zeros) == sum(0 in star for star in scene.world.stars.values())
    for place, star in scene.world.stars.items():
        x, y = drawn.places[place]
        own = [p for p in points if abs(math.dist(p[:2], (x, y)) - shapes.RADIUS) < 0.2]
        turns = [math.atan2(v - b, u - a) for a, b, u, v in own]
        around = [(turn - turns[0]) % (2 * math.pi) for turn in turns]
        assert len(own) == len(star)
        assert around == sorted(around)
        assert (own[0][:2] in zeros) == (0 in star)
    numbers = re.findall(r'class="face[^"]*" x="[^"]*" y="[^"]*">([^<]*)<', text)
    outer = [n for n in numbers if "outer" in n]
    assert len(outer) == 1
    assert sorted(int(n.split()[0]) for n in numbers) == list(range(1, 6))
    _, top, _, high = drawn.frame
    lowest = max(y for _, y in drawn.places.values())
    (y,) = [y for n, (_, _, (_, y)) in enumerate(drawn.faces) if not drawn.faces[n][1]]
    assert lowest + shapes.RADIUS < y < top + high
    for _, outline, point in drawn.faces:
        around = [Outline(line).contains_point(point) for _, line, _ in drawn.faces if line]
        assert sum(around) == bool(outline)
        assert not outline or Outline(outline).contains_point(point)
    steps, told = scene.steps(), re.findall(r'class="along" x="(.*?)" y="(.*?)">([^<]*)<', text)
    assert len(told) == len(scene.world.edges())
    for (a, b), (x, y, named) in zip(scene.world.edges(), told, strict=True):
        assert named == " ".join(map(str, sorted(steps.get(a, []) + steps.get(b, []))))
        begin, end, here = drawn.lines[a][0], drawn.lines[a][-1], (int(x), int(y))
        assert math.dist(begin, here) + math.dist(here, end) < math.dist(begin, end) + 1
    glyph = re.findall(f"({number}) ({number})", svg.agent(drawn, at[-1]))
    x, y = (sum(map(float, ends)) / 3 for ends in zip(*glyph, strict=True))
    (a, b), (u, v) = drawn.lines[at[-1]]
    assert shapes.RADIUS < math.dist((x, y), (a, b)) < 2.5 * shapes.RADIUS
    assert abs(math.atan2(y - b, x - a) - math.atan2(v - b, u - a)) < 0.1


def test_the_agent_is_seen_where_a_line_begins_twice():
    """Coordinates are whole numbers: the first points of a line may be one."""
    drawn = shapes.Drawing({0: (0, 0)}, {(0, 0): [(0, 0), (0, 0), (60, 0)]}, [], (0, 0, 1, 1))
    glyph = re.findall(r"(-?\d+) (-?\d+)", svg.agent(drawn, (0, 0)))
    assert len(set(glyph)) == 3
    assert all(int(x) > shapes.RADIUS for x, _ in glyph)


@pytest.mark.slow
def test_agreement_of_maps():
    seen = read(ROOT / GRID)
    for parts in (("closed", "boundary", "minimal"), ("closed",), ("planar",)):
        ats = sorted(answers(parts, seen.facts()))
        agreed = Agreement(ats, seen)
        pairs = {
            (t, u)
            for t, u in product(range(seen.steps + 1), repeat=2)
            if t < u and all(at[t][0] == at[u][0] for at in ats)
        }
        assert {(t, u) for one in agreed.one for t in one for u in one if t < u} == pairs
        differ = []
        for step in range(seen.steps + 1):
            same = set()
            for at in ats:
                visits = [u for u in range(step) if at[u][0] == at[step][0]]
                turned = visits and (at[step][1] - at[visits[0]][1]) % 4
                same.add((tuple(visits), turned or 0))
            differ += [step] * (len(same) > 1)
        assert [step for step, _ in agreed.differ] == differ
        maps = [seen.map_of(at) for at in ats]
        for number, world in enumerate(maps):
            for out, end in world.edges():
                assert agreed.having(out, end) == sum((out, end) in m.links.items() for m in maps)
            at = ats[number]
            for place in world.stars:
                steps = [step for step, (there, _) in enumerate(at) if there == place]
                sames = [[t for t, d in enumerate(other) if d[0] == place] for other in ats]
                assert (place in agreed.strange(number)) == any(s != steps for s in sames)


@pytest.mark.long
def test_the_same_input_gives_the_same_bytes(tmp_path):
    for seed in "12":
        run(
            *("topomap", "report", GRID, "instances/manhattan-tour20.lp", "--horizon", "4"),
            *("-o", tmp_path / seed),
            env=os.environ | {"PYTHONHASHSEED": seed},
            check=True,
        )
    assert (tmp_path / "1").read_bytes() == (tmp_path / "2").read_bytes()


def hostile(folder):
    """An instance and its name that would like to be more than text."""
    text = EVIL.replace("\\", "\\\\").replace('"', '\\"')
    file = folder / "<b onclick=alert(3)>&quot;'.lp"
    facts = 'slots(4). view(0,0). landmark(0,"%s"). turn(1,0). view(1,0). view(1,2).'
    file.write_text(facts % text + ' landmark(1,"javascript:alert(4)").')
    return file


@pytest.mark.slow
def test_nothing_of_an_instance_is_more_than_text(tmp_path):
    status, page = report(tmp_path / "page.html", hostile(tmp_path))
    assert status == 0
    assert len(page.all("script")) == 1
    assert not page.all("img") + page.all("b")
    assert not [e for e in page.elements for name in e if name.startswith("on")]
    log = next(rows for name, rows in page.tables.items() if name.startswith("Log of"))
    shown = parse(hostile(tmp_path).read_text(), "").landmarks[0]
    assert log[1][4] == next(iter(shown))
    assert EVIL.split("&")[0].replace('"', '\\"') in log[1][4]


def test_it_loads_nothing(three):
    _, page = three
    assert "http" not in page.text.replace('http-equiv="Content-Security-Policy"', "")
    for element in page.elements:
        assert element["tag"] not in ("link", "img", "iframe", "object", "embed", "image")
        assert not {"src", "srcset", "data", "style", "xlink:href"} & set(element)
        assert element.get("href", "#").startswith("#")
    (style,), (script,) = page.all("style"), page.all("script")
    assert not re.search(r"url\(|@import|@font-face", style["text"])
    (policy,) = [m["content"] for m in page.all("meta") if "http-equiv" in m]
    for kind, element in (("style", style), ("script", script)):
        digest = base64.b64encode(hashlib.sha256(element["text"].encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in policy
    assert policy.startswith("default-src 'none';")
    ids = [e["id"] for e in page.elements if "id" in e]
    assert len(ids) == len(set(ids))
    wanted = {e["href"][1:] for e in page.elements if "href" in e}
    wanted |= {e[key] for e in page.elements for key in ("aria-labelledby", "for") if key in e}
    assert wanted <= set(ids)


def test_pictures_and_tables_have_names(three):
    _, page = three
    pictures = [e for e in page.all("svg") if e.get("role") == "img"]
    others = [e for e in page.all("svg") if e.get("role") != "img"]
    assert all(e["aria-hidden"] == "true" for e in others)
    assert len([e for e in pictures if "hypothesis" in e["aria-label"]]) > 40
    assert all(len(e["aria-label"]) > 5 for e in pictures)
    assert len(page.tables) == len(page.all("table")) == len(page.all("caption"))
    assert all("scope" in e for e in page.all("th"))


@pytest.mark.long
def test_a_page_of_maps_that_are_given(tmp_path, capsys):
    """They are the maps of the page, of the kind that is claimed and no other."""
    solved, given = tmp_path / "solved.json", tmp_path / "given.json"
    cli.main(["solve", str(ROOT / GRID), "--closed", "--json", "-o", str(solved)])
    told = json.loads(solved.read_text())
    values = [[f"at({t},{p},{s})" for t, p, s in one["at"]] for one in told["maps"]]
    answer = {
        "Call": [{"Witnesses": [{"Value": value} for value in values]}],
        "Models": {"Number": len(values), "More": "no"},
    }
    limit = "--timeout", "2", "--maps", "2"
    for more, others in (("no", ""), ("yes", ", others may exist")):
        answer["Models"]["More"] = more
        given.write_text(json.dumps(answer))
        _, page = report(tmp_path / "page.html", ROOT / GRID, "--maps-from", given, *limit)
        text = " ".join(page.text.split())
        assert f"{len(values)} maps given{others}; the first 2 are shown." in text
        assert "The maps given" in text
        assert "The best maps" not in text
        assert "Visits that are at one place in all the maps given:" in text
        assert f"--maps-from {given}" in text
    _, page = report(tmp_path / "page.html", ROOT / GRID, "--maps-from", solved, *limit)
    assert f"{len(values)} maps given: consistent; the first 2" in " ".join(page.text.split())
    capsys.readouterr()
    other = ROOT / "instances/grid-3x4-paper.lp"
    for call, fault in (
        ((other,), f"{given}: map 1: 16 steps, but the instance has 21"),
        ((ROOT / GRID, "--planar"), "it breaks the rule planar of check.lp"),
        ((ROOT / GRID, "--bound", "8"), "it breaks the rule bound(8) of check.lp"),
        ((ROOT / GRID, other), "topomap report: --maps-from goes with one instance"),
    ):
        none = tmp_path / "none.html"
        call = ["report", *map(str, call), "--maps-from", str(given), "-o", str(none)]
        assert cli.main(call) == 2
        told = capsys.readouterr().err
        assert (told.count("\n"), none.exists()) == (1, False)
        assert fault in told


@pytest.mark.slow
def test_each_map_names_what_it_breaks(tmp_path, capsys):
    """The best map of the oxbow breaks what check --all says, and its exceptions are named."""
    oxbow, out, maps = ROOT / "tests/cases/oxbow.lp", tmp_path / "page.html", tmp_path / "maps.json"
    assert cli.main(["report", str(oxbow), "--planar", "-o", str(out)]) == 0
    call = ["solve", str(oxbow), "--planar", "--optimal", "--json", "-o", str(maps)]
    assert cli.main(call) == 0
    assert cli.main(["check", "--all", str(oxbow), str(maps), "--json"]) == 0
    (told,) = json.loads(capsys.readouterr().out)["judged"]
    text = unescape(out.read_text())
    assert (told["breaks"].keys(), len(told["exceptions"])) == ({"boundary", "perpendicular"}, 5)
    keeps = ", ".join(told["keeps"])
    assert f"it breaks {', '.join(told['breaks'])}; keeps {keeps}." in text
    assert text.count("paths 2 and 6 meet twice, at places 1 and 3; place 3 is left") == 1


def test_a_limit_leaves_a_page_that_says_so(tmp_path, capsys):
    status, page = report(tmp_path / "page.html", ROOT / LARGE, "--timeout", "0.001")
    assert status == 3
    assert "This page is partial" in page.text
    assert "counts by clingo: timeout" in page.text
    rows = page.tables[f"Hypotheses after each step of {ROOT / LARGE}"][1:]
    assert rows[-1] == ["30", "not counted", "not counted"]
    assert ": partial: counts by clingo: timeout" in capsys.readouterr().err


def test_an_interrupt_leaves_a_page_that_says_so(tmp_path):
    file = tmp_path / "page.html"
    file.write_text("old")
    command = [BIN / "topomap", "report", LARGE, "-o", file]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) as process:
        while not list(tmp_path.glob(".topomap-*")):
            time.sleep(0.05)
        time.sleep(0.5)
        assert file.read_text() == "old"
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
        assert "partial: counts by clingo: interrupted" in process.stderr.read()
    page = Page(file.read_text())
    assert "This page is partial" in page.text
    assert "interrupted" in page.text
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.lp"], "none.lp: no such file"),
        ([GRID, GRID], "named twice"),
        ([GRID, "--maps", "-1"], "--maps"),
        ([GRID, "pyproject.toml"], "pyproject.toml:"),
    ],
)
def test_bad_input_is_one_line(topomap, tmp_path, arguments, words):
    file = tmp_path / "page.html"
    file.write_text("old")
    done = topomap("report", *arguments, "-o", file)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert words in done.stderr
    assert file.read_text() == "old"


@pytest.mark.slow
def test_no_map_and_no_step(tmp_path):
    status, page = report(tmp_path / "page.html", ROOT / GRID, "--bound", "3", "--horizon", "9")
    assert status == 1
    assert "There is no map." in page.text
    counts = page.tables[f"Hypotheses after each step of {ROOT / GRID}"][1:]
    ended = next(step for step, any_map, _ in counts if any_map == "0")
    told = " ".join(page.text.split())
    assert f"<strong>No hypothesis is left after step {ended}.</strong> Of those" in told
    assert "before 1 ends there: there would be too many places." in told
    refused = page.tables[f"Arrivals tried and refused at each step of {ROOT / GRID}"]
    assert "ended: bound" in refused[1]
    status, page = report(tmp_path / "page.html", ROOT / GRID, "--horizon", "0")
    assert status == 0
    assert "No hypothesis is left" not in page.text
    assert "1 map found: best so far" in page.text


@pytest.mark.slow
def test_fewer_maps_than_there_are(tmp_path):
    status, page = report(tmp_path / "page.html", ROOT / GRID, "--horizon", "4", "--maps", "0")
    assert status == 0
    assert "1 map found: best so far; the first 0 are shown." in " ".join(page.text.split())
    assert not [e for e in page.all("figure") if e["class"] == "best"]


@pytest.mark.long
@pytest.mark.parametrize(
    ("arguments", "numbers"),
    [(["--timeout", "400"], ["920,024", "49,123"]), (["--bound", "16"], ["23,685", "545"])],
)
def test_large_pages(tmp_path, arguments, numbers):
    file = tmp_path / "page.html"
    status, page = report(file, ROOT / LARGE, *arguments)
    assert status == 0
    assert file.stat().st_size < 1_000_000
    rows = page.tables[f"Hypotheses after each step of {ROOT / LARGE}"][1:]
    assert rows[-1] == ["30", *numbers]


def test_the_size_of_the_page(three):
    assert three[0].stat().st_size < 150_000


def luminance(colour):
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


@pytest.mark.parametrize("scheme", [0, 1])
def test_colours_contrast(scheme):
    """As WCAG 2 wants it: 4.5 for text, 3 for lines."""
    style = (FOLDER / "page.css").read_text()
    roots = re.findall(r":root \{(.*?)\}", style, re.DOTALL)
    assert len(roots) == 2
    colours = dict(re.findall(r"--(\w+): (#[0-9a-f]{6});", roots[scheme]))

    def contrast(a, b):
        low, high = sorted(luminance(colours[name]) for name in (a, b))
        return (high + 0.05) / (low + 0.05)

    for text, behind in [
        *product(("ink", "soft"), ("paper", "panel", "f0", "f1", "f2", "f3")),
        *(("ink", "mark"), ("ink", "place"), ("ink", "signed"), ("accent", "panel")),
        *(("accent", "paper"), ("sign", "paper"), ("apart", "paper"), ("apart", "mark")),
    ]:
        assert contrast(text, behind) >= 4.5, (text, behind)
    for line in ("link", "apart", "crossing", "pending", "agent", "focus"):
        assert contrast(line, "paper") >= 3, line


# In a browser.


@pytest.fixture
def shown(browser, three):
    """The page of the 3 x 3 grid, at its beginning, in a window that is wide."""
    size(browser, 1280)
    browser.get(three[0].as_uri())
    return browser


def size(browser, width):
    metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


def state(browser):
    """What is shown: the step by the slider, the label, the words, the log and the pictures."""
    return browser.execute_script(
        """
        const visible = (e) => e.getClientRects().length > 0;
        const all = (what) => [...document.querySelectorAll(what)];
        return {
          slider: Number(document.querySelector("input[type=range]").value),
          label: document.querySelector(".slide label").textContent,
          says: document.querySelector("[aria-live]").textContent,
          rows: all("tr[aria-current=step]").map((row) => Number(row.dataset.step)),
          pictures: all(".steps svg").filter(visible).map((e) => e.getAttribute("aria-label")),
          more: all(".steps .more").filter(visible).map((e) => e.textContent),
          now: document.querySelector(".now").getBoundingClientRect().left,
        };"""
    )


@pytest.fixture(scope="module")
def truth():
    """The figures of all hypotheses after each step, by stock clingo."""
    seen = read(ROOT / GRID)
    return [[figures(seen, at) for at in level] for level in levels(seen.facts())]


def demand(browser, step, truth):
    """That the page shows a step, with hypotheses of the solver, and says how many there are."""
    got = state(browser)
    level = truth[step]
    assert got["slider"] == step
    assert got["label"] == f"Step {step} of 16"
    assert got["rows"] == [step] * (3 if step else 2)  # the log, the counts, what was refused
    assert got["says"].startswith(f"Step {step}: ")
    assert got["says"].endswith(f"; {len(level)} hypothes{'is' if len(level) == 1 else 'es'}")
    assert len(got["pictures"]) == min(SHOWN, len(level))
    named = [re.fullmatch(r"After step (\d+), hypothesis (\d+): (.*)", p) for p in got["pictures"]]
    assert [(int(m[1]), int(m[2])) for m in named] == [(step, n + 1) for n in range(len(named))]
    assert not Counter(m[3] for m in named) - Counter(level)
    (more,) = got["more"]
    left = len(level) - len(named)
    assert (f"{left} more" in more) if left else more == "These are all."
    return got


@pytest.mark.slow
def test_replay_by_keys(shown, truth):
    from selenium.webdriver import ActionChains, Keys

    def press(key):
        ActionChains(shown).send_keys(key).perform()

    first = demand(shown, 0, truth)
    for step in range(1, 17):  # nothing has the focus
        press(Keys.ARROW_RIGHT)
        got = demand(shown, step, truth)
    assert got["now"] > first["now"] + 300
    press(Keys.ARROW_RIGHT)
    demand(shown, 16, truth)
    press(Keys.ARROW_LEFT)
    demand(shown, 15, truth)
    slider = shown.find_element("css selector", "input[type=range]")
    for key, step in (
        (Keys.HOME, 0),
        (Keys.ARROW_RIGHT, 1),
        (Keys.ARROW_UP, 2),
        (Keys.END, 16),
        (Keys.ARROW_LEFT, 15),
    ):
        slider.send_keys(key)
        demand(shown, step, truth)
    button = shown.find_element("css selector", "button")
    for key, step in ((Keys.HOME, 0), (Keys.ARROW_RIGHT, 1), (Keys.END, 16), (Keys.ARROW_LEFT, 15)):
        button.send_keys(key)
        demand(shown, step, truth)


@pytest.mark.slow
def test_replay_by_pointer(shown, truth):
    from selenium.webdriver import ActionChains

    def click(what):
        shown.find_element("css selector", f"button[data-go={what}]").click()

    for what, step in [
        *(("next", 1), ("next", 2), ("back", 1), ("back", 0), ("back", 0)),
        *(("last", 16), ("next", 16), ("back", 15), ("first", 0)),
    ]:
        click(what)
        demand(shown, step, truth)
    slider = shown.find_element("css selector", "input[type=range]")
    ActionChains(shown).move_to_element(slider).click().perform()
    demand(shown, 8, truth)
    drag = ActionChains(shown).move_to_element(slider).click_and_hold()
    drag.move_by_offset(slider.size["width"] // 2, 0).release().perform()
    demand(shown, 16, truth)


def test_nothing_is_loaded_and_nothing_complains(browser, three):
    import json

    browser.get_log("performance")
    browser.get_log("browser")
    browser.get(three[0].as_uri())
    assert browser.get_log("browser") == []
    events = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    asked = [e["params"] for e in events if e["method"] == "Network.requestWillBeSent"]
    page = three[0].as_uri()  # the first page of a browser that has just begun loads other things
    assert [e["request"]["url"] for e in asked if e["documentURL"] == page] == [page]


@pytest.mark.parametrize("width", [1280, 400])
@pytest.mark.parametrize("place", ["first", "last"])
def test_the_page_is_as_wide_as_the_window(shown, width, place):
    size(shown, width)
    shown.execute_script(
        "document.querySelector(`button[data-go=${arguments[0]}]`).click();"
        "for (const d of document.querySelectorAll('.best details')) d.open = true;",
        place,
    )
    wide, window, out = shown.execute_script(
        """const root = document.documentElement;
        const right = (e) => e.getBoundingClientRect().right;
        const out = [...document.querySelectorAll("body *")].filter((e) =>
          !e.closest("table, pre, svg") && right(e) > root.clientWidth + 1);
        return [root.scrollWidth, root.clientWidth, out.map((e) => e.outerHTML.slice(0, 80))];"""
    )
    smallest = shown.execute_script(
        """return Math.min(...[...document.querySelectorAll(".hypothesis svg, .plot, .best svg")]
        .filter((svg) => svg.getClientRects().length).map((svg) =>
          9.5 * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width));"""
    )
    assert smallest > 8  # the height of the smallest letters
    assert wide <= window
    assert window > width - 20
    assert out == []


def tree(browser):
    """The accessibility tree, as (role, name, value)."""
    nodes = browser.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    kept = [node for node in nodes if not node["ignored"]]
    return [
        tuple(node.get(key, {}).get("value", "") for key in ("role", "name", "value"))
        for node in kept
    ]


def test_the_accessibility_tree(shown, truth):
    from selenium.webdriver import Keys

    name = str(ROOT / GRID)
    shown.find_element("css selector", "input[type=range]").send_keys(*[Keys.ARROW_RIGHT] * 8)
    nodes = tree(shown)
    named = {(role, text) for role, text, _ in nodes}
    for heading in ("Report on an exploration", name, "Replay", "What was refused"):
        assert ("heading", heading) in named
    assert [n for n in nodes if n[0] == "slider"] == [("slider", "Step 8 of 16", 8)]
    for button in ("First", "Back", "Next", "Last"):
        assert ("button", button) in named
    images = [text for role, text, _ in nodes if role == "image"]
    of_step = [text for text in images if text.startswith("After step")]
    assert len(of_step) == min(SHOWN, len(truth[8]))
    assert [text for text in images if text.startswith("Map 1 of 2, optimal: 9 places")]
    assert "Hypotheses after each step of grid-3x3-snake, on a logarithmic scale" in images
    assert all(images)
    for table in ("Log of", "Hypotheses after each step of", "Arrivals tried and refused at"):
        assert [text for role, text, _ in nodes if role == "table" and text.startswith(table)]
    assert all(text for role, text, _ in nodes if role in ("table", "region", "navigation"))
    for role in ("main", "banner", "navigation", "status"):
        assert role in {r for r, _, _ in nodes}


def test_the_focus_is_seen(shown):
    from selenium.webdriver import ActionChains, Keys

    seen = set()
    for _ in range(17):
        ActionChains(shown).send_keys(Keys.TAB).perform()
        tag, style, outline = shown.execute_script(
            "const e = document.activeElement, s = getComputedStyle(e);"
            "return [e.tagName, s.outlineStyle, parseFloat(s.outlineWidth)];"
        )
        assert style == "solid", tag
        assert outline >= 2, tag
        seen.add(tag)
    assert {"A", "BUTTON", "INPUT", "DIV", "SUMMARY"} <= seen


def test_without_script_all_steps_are_there(browser, three):
    switch = "Emulation.setScriptExecutionDisabled"
    size(browser, 1280)
    browser.execute_cdp_cmd(switch, {"value": True})
    try:
        browser.get(three[0].as_uri())
        nodes = tree(browser)
    finally:
        browser.execute_cdp_cmd(switch, {"value": False})
    steps = [n for n in nodes if n[0] == "DisclosureTriangle" and n[1].startswith("Step ")]
    assert len(steps) == 17
    assert not [n for n in nodes if n[0] in ("slider", "button")]


@pytest.mark.slow
def test_hostile_landmarks_do_not_run(browser, tmp_path):
    from selenium.common.exceptions import NoAlertPresentException

    file = tmp_path / "page.html"
    assert report(file, hostile(tmp_path))[0] == 0
    browser.get_log("browser")
    browser.get(file.as_uri())
    with pytest.raises(NoAlertPresentException):
        _ = browser.switch_to.alert
    assert browser.get_log("browser") == []
    table = browser.find_element("css selector", ".side table").text
    assert "<script>alert(1)</script>" in table
    assert browser.execute_script("return document.scripts.length") == 1


@pytest.mark.slow
def test_no_text_is_cut_off(browser, tmp_path):
    """Nor are landmarks over each other or on places, and they are short, without quotes."""
    signs = ['"$x^$_{"', 'f("a$b")', '"日本"', f'"{"W" * 200}"', '"many more letters"', '"b"']
    facts = [f"slots(4). view(0,0). landmark(0,{signs[0]})."]
    for step, sign in enumerate(signs[1:], 1):
        turn, ahead = 2 * (step > 1), f"view({step},2)." * (step < len(signs) - 1)
        facts.append(f"turn({step},{turn}). view({step},0). {ahead} landmark({step},{sign}).")
    (tmp_path / "a.lp").write_text("\n".join(facts))
    assert report(tmp_path / "a.html", tmp_path / "a.lp")[0] == 0
    size(browser, 1280)
    browser.get((tmp_path / "a.html").as_uri())
    texts, cut, wide, frame = browser.execute_script(
        """const svg = document.querySelector("svg.large"), frame = svg.viewBox.baseVal;
        const texts = [...svg.querySelectorAll("text")].map((t) => [t, t.getBBox()]);
        const cut = texts.filter(([t, b]) => b.x < frame.x || b.y < frame.y ||
          b.x + b.width > frame.x + frame.width || b.y + b.height > frame.y + frame.height);
        const box = ([t, b]) => [t.textContent, b.x, b.y, b.x + b.width, b.y + b.height];
        const edges = [frame.x, frame.y, frame.x + frame.width, frame.y + frame.height];
        return [texts.filter(([t]) => t.matches(".sign")).map(box), cut.map(box),
                svg.getBoundingClientRect().width / frame.width, edges];"""
    )
    assert [name for name, *_ in texts] == [
        line for sign in signs for line in words.sign_lines([sign])
    ]
    assert not cut, (cut, frame)
    assert 1 < wide <= 1.71
    for (_, *one), (_, *other) in combinations(texts, 2):
        apart = one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]
        assert apart, (one, other)


@pytest.mark.slow
def test_several_explorations_on_one_page(browser, tmp_path):
    from selenium.webdriver import ActionChains, Keys

    file = tmp_path / "page.html"
    other = "instances/manhattan-tour20.lp"
    assert report(file, ROOT / GRID, ROOT / other, "--horizon", "5")[0] == 0
    browser.get(file.as_uri())
    first, second = browser.find_elements("css selector", "input[type=range]")
    ActionChains(browser).send_keys(Keys.ARROW_RIGHT).perform()
    second.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    browser.execute_script("document.activeElement.blur()")
    ActionChains(browser).send_keys(Keys.ARROW_RIGHT).perform()
    assert [int(slider.get_attribute("value")) for slider in (first, second)] == [1, 3]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark(shown, scheme):
    feature = {"name": "prefers-color-scheme", "value": scheme}
    shown.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
    colours = shown.execute_script(
        "const s = getComputedStyle(document.body); return [s.color, s.backgroundColor];"
    )
    shown.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    ink, paper = (sum(map(int, re.findall(r"\d+", colour)[:3])) for colour in colours)
    assert (ink < paper) == (scheme == "light")
