"""Long runs are resumed where they were cut, and come to the same numbers."""

import json
import os
import random
import subprocess
import time
from pathlib import Path

import pytest
from conftest import BIN, ROOT, TRIED
from topomap import beyond, solver
from topomap.cli import main
from topomap.errors import InputError
from topomap.journal import Journal

GRID = str(ROOT / "instances/grid-3x3-snake.lp")
PAPER = str(ROOT / "instances/grid-3x4-paper.lp")
SNAKE = str(ROOT / "instances/grid-4x4-snake.lp")
LONG_RUNS = {
    "count": ["count", PAPER],
    "count, JSON": ["count", PAPER, "--planar", "--json"],
    "solve": ["solve", PAPER],
    "solve, JSON": ["solve", PAPER, "--boundary", "--json"],
    "solve by search": ["solve", PAPER, "--by", "search"],
    "solve two": ["solve", GRID, PAPER, "--json"],
}


class Cut(Exception):
    """A run is cut."""


@pytest.fixture
def cut_after(monkeypatch):
    """Cut a run when so many units are done, as a kill would: nothing is tidied up."""
    commit = Journal.commit

    def cut(units):
        left = iter(range(units))

        def commit_or_cut(self):
            commit(self)
            if next(left, None) is None:
                raise Cut

        monkeypatch.setattr(Journal, "commit", commit_or_cut)

    yield cut


@pytest.mark.parametrize("name", LONG_RUNS)
def test_a_run_that_was_cut_goes_on(tmp_path, cut_after, monkeypatch, name):
    whole, file = tmp_path / "whole", tmp_path / "file"
    assert main([*LONG_RUNS[name], "-o", str(whole)]) == 0
    draw = random.Random(name)
    cuts = 0
    while not file.exists():
        with monkeypatch.context() as patch:
            patch.setattr(Journal, "commit", Journal.commit)
            cut_after(draw.randrange(60))
            try:
                assert main([*LONG_RUNS[name], "-o", str(file), "--resume"]) == 0
            except Cut:
                cuts += 1
                assert [p.name for p in tmp_path.iterdir()].count("file") == 0
    assert cuts > 1
    assert file.read_bytes() == whole.read_bytes()
    assert {p.name for p in tmp_path.iterdir()} == {"whole", "file"}
