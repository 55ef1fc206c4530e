"""The rows of rows.toml."""

import json
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
ROWS = Path(__file__).with_name("rows.toml")
WAYS = ("baseline", "work", "search")
KNOWN = {
    "ask": ("count", "maps", "one", "table", "command"),
    "ways": WAYS,
    "goal": ("rules", "choices", "conflicts", "seconds", "memory", "solved"),
    "growth": ("steps", "kinds"),
}


@dataclass(frozen=True)
class Row:
    """A task, and what is known of it; rows.toml says what each field means."""

    name: str
    ask: str
    generate: str = ""
    parts: list[str] = field(default_factory=list)
    places: int | str | None = None
    expected: int | None = None
    why: str = ""
    goal: dict[str, Any] = field(default_factory=dict)
    ways: tuple[str, ...] = WAYS
    series: str = ""
    growth: str = ""
    cut: float | None = None
    large: bool = False
    quick: bool = False

    def __post_init__(self) -> None:
        for key, known in KNOWN.items():
            value = getattr(self, key)
            for word in [value] if isinstance(value, str) else value:
                if word and word not in known:
                    raise ValueError(f"{self.name}: {key}: {word} is not one of {', '.join(known)}")


def read(path: Path = ROWS) -> tuple[dict[str, str], list[Row]]:
    """What the baseline is, and the rows."""
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    return tables["baseline"], [row for table in tables["row"] for row in _rows(table)]


def _rows(table: dict[str, Any]) -> list[Row]:
    values, large = table.pop("each", [None]), table.pop("large", [])
    goals, quick = table.pop("goals", {}), table.pop("quick", 0)
    expected = table.pop("expected", None)
    if isinstance(expected, dict):
        expected = _written(**expected)
    rows = []
    for number, n in enumerate([*values, *large]):
        here: dict[str, Any] = {"goal": goals.get(str(n), {}), **table}
        for key in ("name", "generate"):
            here[key] = here.get(key, "").replace("{n}", str(n))
        marks = {"large": n in large, "quick": number < quick}
        rows.append(Row(**here, **marks, expected=expected))
    return rows


def _written(file: str, key: str, **where: Any) -> int:
    """A figure of the one entry of a JSON file that has these values."""
    document = json.loads((ROOT / file).read_text(encoding="utf-8"))
    entries = document.get("columns") or document["rows"]
    (entry,) = (e for e in entries if all(e[name] == value for name, value in where.items()))
    for word in key.split("."):
        entry = entry[word]
    assert isinstance(entry, int)
    return entry
