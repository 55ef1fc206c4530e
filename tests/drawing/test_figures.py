"""The figures: what they show is computed, and the committed ones are what is drawn."""

import re

import numpy as np
import pytest
from conftest import ROOT
from topomap.cli import main
from topomap.model.facts import read
from topomap.paper import figures
from topomap.runtime.watch import Watch
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

QUIET = Watch()
DOCS = ROOT / "docs/figures"
NAMES = list(figures.figures(ROOT / "instances", QUIET))
SOON = "circumscription", "first", "place", "figure1", "figure3", "equation1"


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [n if n in SOON else pytest.param(n, marks=pytest.mark.long) for n in NAMES],
)
def test_the_committed_figures_are_what_is_drawn(tmp_path, monkeypatch, name):
    """By their texts and parts; and where no line bends, by the coordinates, except for what may
    differ from machine to machine."""
    monkeypatch.chdir(ROOT)
    assert main(["figures", name, "-d", str(tmp_path)]) == 0
    drawn, committed = ((folder / f"{name}.svg").read_text() for folder in (tmp_path, DOCS))
    assert words(drawn) == words(committed)
    if name in ("place", "figure3", "figure4", "equation1"):
        one, other = coordinates(drawn), coordinates(committed)
        assert len(one) == len(other) > 100
        assert np.allclose(one, other, atol=2)


def words(svg):
    """The texts and the named parts of a picture."""
    return re.findall(r"<text [^>]*>([^<]*)</text>", svg), re.findall(r'<g id="([\w.-]+)"', svg)


def coordinates(svg):
    """Of lines, and of marks."""
    drawn = re.findall(r'\b(?:d|x|y)="([^"]*)"', svg)
    return np.array(re.findall(r"-?\d+(?:\.\d+)?", " ".join(drawn)), float)


def test_a_figure_that_is_not_there(capsys, tmp_path):
    assert main(["figures", "figure9", "-d", str(tmp_path)]) == 2
    assert "figure9: the figures are figure1, " in capsys.readouterr().err
    assert not any(tmp_path.iterdir())


def test_maps_that_walks_distinguish():
    """Walks distinguish no optimal 3x3 map from the grid, and one of the two of 4x4."""
    for size, told in ((3, [False, False]), (4, [False, True])):
        experience = read(ROOT / f"instances/grid-{size}x{size}-snake.lp")
        made = instance(grid(size, size), "snake")
        real = experience.map_of(made.truth)
        optimal = figures.best_scenes(experience, QUIET)
        pairs = [(scene.world, scene.at[-1]) for scene in optimal]
        same = [world.indistinguishable(at, real, made.truth[-1]) for world, at in pairs]
        assert sorted(not one for one in same) == told
        assert all(
            walk_differs(world, at, real, made.truth[-1]) != one
            for (world, at), one in zip(pairs, same, strict=True)
        )


def walk_differs(world, here, other, there):
    """Whether some walk sees a difference, by trying all of them, breadth first, up to a length
    that is enough for as many pairs of dstates as there are."""
    level = {(here, there)}
    for _ in range(60):
        if any(world.view(a) != other.view(b) for a, b in level):
            return True
        level = {
            (world.links[a[0], (a[1] + turn) % 4], other.links[b[0], (b[1] + turn) % 4])
            for a, b in level
            for turn in world.view(a)
        }
    return False
