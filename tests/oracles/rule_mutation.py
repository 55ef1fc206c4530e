"""Rule mutation: every encoding, changed in one place at a time, must give a wrong answer
to some query of tests/oracles/known_answers.py, except for the mutants that
tests/oracles/equivalent.toml proves to be equivalent. ``make mutate`` tries them all and writes
docs/mutation.md.

Exit status: 0 so it is; 1 a mutant survives that is not listed, or one is listed that does
not survive or does not exist; 2 bad input or usage; 130 interrupted.
"""

import argparse
import hashlib
import math
import os
import platform
import random
import re
import resource
import signal
import sys
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby, product
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import clingo
from clingo import ast
from conftest import ENCODINGS, ROOT
from topomap.runtime.errors import InputError
from topomap.runtime.files import output
from topomap.runtime.limits import LARGEST
from tqdm import tqdm

from oracles.known_answers import Query, queries, sizes

LISTED = ROOT / "tests/oracles/equivalent.toml"
REPORT = ROOT / "docs/mutation.md"
KINDS = ("remove", "drop", "negate", "shift")
UNTRIED = "untried"  # as there was no time
FATES = ("survived", "killed", "refused", "endless", "larger", UNTRIED)
SECONDS = 5  # of the processor, for one query: the encodings take milliseconds
BYTES = 2 << 30
QUERIES = 100  # for a listed mutant at most: that many settle nearly all that any query settles
HEAD = """# Rule mutation

Written by `make mutate`, with clingo {clingo} and Python {python}.

A mutant is an encoding changed in one place: a statement removed; a literal of a body or of a
condition dropped; one negated, or a comparison turned into its complement; a number made one
greater or one less. Mutants that read the same are one. Each is asked at most {most:,} of the
{all:,} queries of `tests/oracles/known_answers.py`, or
more in a run that this one went on with, of those that load it, whose answers are known without the
encodings: by turns one that settled most mutants of the same rule or file, one that gives most of
what the rule is about, one that does so with other files, and one at random. It is *killed* when
one gives other answers (other models, shown atoms or costs, or a model twice), *refused* when
clingo has an error or a message for it, *endless* when a query takes more than {seconds} seconds of
the processor or {memory} MiB of memory. (If the encoding without the change gives other answers
too, the run ends with an error.) When these answers are right, a mutant of an encoding whose worth
is in its size, too, is *larger* if it grounds to more rules at the first of {sizes} queries at
which the number is another one: some of the named experiences with all the parts, some with what is
told besides views, and some of what `phases/`, `online/` and the checker are asked.
Another one is *equivalent* if `tests/oracles/equivalent.toml` says why. If this file does not list
it, it is asked all queries that load it. If none of them kills it, it has *survived*: a query or a
proof is missing. It is *untried* if there was no time. Comments, `#include` and `#heuristic`, which
is but an order of the search, are not mutated.
"""
COMPLEMENT = {
    ast.ComparisonOperator.Equal: ast.ComparisonOperator.NotEqual,
    ast.ComparisonOperator.LessThan: ast.ComparisonOperator.GreaterEqual,
    ast.ComparisonOperator.GreaterThan: ast.ComparisonOperator.LessEqual,
}
COMPLEMENT |= {other: one for one, other in COMPLEMENT.items()}


INCLUDE = re.compile(r'^#include "(.+)\.lp"\.', re.MULTILINE)

Trials = Callable[[list["Mutant"], dict["Mutant", str]], Iterator["Tried"]]
Key = tuple[str, str, str]  # the file, the rule and the change of a mutant
Programs = dict[tuple[str, ...], str]  # by the files of a query


class Tried(NamedTuple):
    """A mutant with its fate; and the name of the query that settled it, or nothing."""

    mutant: "Mutant"
    fate: str
    query: str


@dataclass(frozen=True)
class Mutant:
    """An encoding in which one statement reads ``text``; known by file, rule and change."""

    file: str
    rule: str
    change: str
    kind: str
    number: int
    text: str

    @property
    def key(self) -> Key:
        return self.file, self.rule, self.change

    def __str__(self) -> str:
        return " | ".join(self.key)


def named_files(folder: Path) -> list[str]:
    """The encodings under a folder."""
    return sorted(str(path.relative_to(folder))[:-3] for path in folder.rglob("*.lp"))


def statements(folder: Path, file: str) -> list[ast.AST]:
    """The statements of an encoding, without its includes and comments. Where it is of a
    program part, that is said first."""
    lines = (folder / f"{file}.lp").read_text(encoding="utf-8").splitlines()
    text = "\n".join(line for line in lines if not line.startswith("#include"))
    found: list[ast.AST] = []
    ast.parse_string(text, found.append)
    return [
        statement
        for statement in found
        if statement.ast_type != ast.ASTType.Comment and str(statement) != "#program base."
    ]


def closure(folder: Path, files: tuple[str, ...]) -> tuple[str, ...]:
    """These encodings and all that they include."""
    found: list[str] = []
    waiting = [*files]
    while waiting:
        if (file := waiting.pop()) not in found:
            found.append(file)
            text = (folder / f"{file}.lp").read_text(encoding="utf-8")
            names = (Path(file).parent / name for name in INCLUDE.findall(text))
            waiting += [os.path.normpath(name) for name in names]
    return tuple(found)


def sets(folder: Path, asked: list[Query]) -> dict[tuple[str, ...], tuple[str, ...]]:
    """What is loaded by each set of files that a query names."""
    return {files: closure(folder, files) for files in dict.fromkeys(q.files for q in asked)}


def whole_program(files: Iterable[Sequence[str]]) -> str:
    """The statements of several files, each of which begins as the base program, as for clingo."""
    return "\n".join(text for texts in files for text in ("#program base.", *texts))


def mutants(folder: Path, file: str) -> list[Mutant]:
    """The mutants of an encoding; of those that read the same, one. If one change can be made at
    several places of a statement, the later ones are numbered: (2) and so on."""
    found = {}
    for number, statement in enumerate(statements(folder, file)):
        if statement.ast_type in (ast.ASTType.Heuristic, ast.ASTType.Program):
            continue
        rule = str(statement)
        found[number, ""] = Mutant(file, rule, "remove", "remove", number, "")
        made: Counter[str] = Counter()
        for kind, change, node in changes(statement):
            text = str(node)
            if text != rule and (number, text) not in found:
                made[change] += 1
                name = f"{change} ({made[change]})" if made[change] > 1 else change
                found[number, text] = Mutant(file, rule, name, kind, number, text)
    return list(found.values())


def changes(node: ast.AST, body: bool = False) -> Iterator[tuple[str, str, ast.AST]]:
    """What one change makes of a node: its kind, its text, and the changed node. ``body``
    tells whether the node is part of a body or of a condition."""
    if node.ast_type == ast.ASTType.Literal and body:
        yield "negate", "", negated(node)
    if node.ast_type == ast.ASTType.SymbolicTerm and node.symbol.type == clingo.SymbolType.Number:
        for other in (node.symbol.number + 1, node.symbol.number - 1):
            if abs(other) <= LARGEST:
                yield "shift", "", node.update(symbol=clingo.Number(other))
    for key in node.child_keys:
        child = getattr(node, key)
        literals = key in ("body", "condition")
        if child is None:
            continue
        if isinstance(child, ast.AST):
            for kind, change, new in changes(child, body):
                yield kind, change or named(key, child, new), node.update(**{key: new})
            continue
        for place, item in enumerate(child):
            before, after = list(child[:place]), list(child[place + 1 :])
            if literals:
                yield "drop", f"drop {item}", node.update(**{key: before + after})
            for kind, change, new in changes(item, body or literals):
                change = change or named(key, item, new)
                yield kind, change, node.update(**{key: [*before, new, *after]})


def named(key: str, old: ast.AST, new: ast.AST) -> str:
    """The text of a change, once it is one of a literal, a head, or a part of one that has
    no other name; until then none."""
    if key in ("weight", "priority", "value"):
        return f"{key} {old} -> {new}"
    if old.ast_type == ast.ASTType.Literal or key in ("head", "left_guard", "right_guard"):
        return f"{str(old).strip()} -> {str(new).strip()}"
    return ""


def negated(literal: ast.AST) -> ast.AST:
    """``not a`` of ``a``, and the other way about; of a comparison its complement."""
    atom = literal.atom
    if atom.ast_type == ast.ASTType.Comparison and len(atom.guards) == 1:
        guard = atom.guards[0]
        opposite = COMPLEMENT[ast.ComparisonOperator(guard.comparison)]
        return literal.update(atom=atom.update(guards=[guard.update(comparison=opposite)]))
    sign = ast.Sign.Negation if literal.sign == ast.Sign.NoSign else ast.Sign.NoSign
    return literal.update(sign=sign)


def tried(program: str, query: Query) -> str:
    """The fate of a program at a query: refused if clingo has a message or an error."""
    messages: list[str] = []
    arguments = ["0", *query.arguments]
    control = clingo.Control(arguments, logger=lambda _, text: messages.append(text))
    try:
        control.add("base", [], program)
        control.add("base", [], query.facts)
        control.ground([("base", [])])
        for number, step in enumerate(query.steps):
            go(control, number, step, query.parts)
    except RuntimeError:
        return "refused"
    if messages:
        return "refused"
    optimal = "--opt-mode=optN" in query.arguments
    together = any(argument.startswith("--enum-mode=") for argument in query.arguments)
    found = []

    def read(model: clingo.Model) -> bool:
        if optimal and not model.optimality_proven:
            return True
        if together:  # each model comes nearer to what holds in all, or in some; the last is it
            found.clear()
        found.append((tuple(model.cost), frozenset(map(str, model.symbols(shown=True)))))
        if together:
            return True
        return found[-1] in query.answers and len(found) <= len(query.answers)

    control.solve(on_model=read)
    right = len(found) == len(query.answers) and set(found) == query.answers
    return "survived" if right else "killed"


def go(control: clingo.Control, number: int, step: str, parts: tuple[str, ...]) -> None:
    """Ground the facts of a step and what belongs to it; or take a step back."""
    if step.isdigit():
        control.release_external(clingo.Function("active", [clingo.Number(int(step))]))
        return
    control.add(f"facts{number}", [], step)
    visits = re.findall(r"(?:view|passed)\((\d+),", step)
    mine = [(part, [clingo.Number(int(visits[0]))]) for part in parts if visits]
    control.ground([(f"facts{number}", []), *mine])


def rules(program: str, query: Query) -> int:
    """How many rules a program grounds to."""
    told = [word for word in query.arguments if word == "-c" or ("=" in word and word[0] != "-")]
    control = clingo.Control(["1", "--opt-mode=ignore", *told])
    control.add("base", [], program)
    control.add("base", [], query.facts)
    control.ground([("base", [])])
    for number, step in enumerate(query.steps):
        go(control, number, step, query.parts)
    control.solve()
    return int(control.statistics["problem"]["lp"]["rules"])


def name_of(query: Query) -> str:
    """A name of what a query asks, and of its answers, that is the same in each process."""
    answers = sorted((cost, sorted(atoms)) for cost, atoms in query.answers)
    asked = query.files, query.facts, query.arguments, query.steps, query.parts, answers
    return hashlib.sha256(repr(asked).encode()).hexdigest()[:16]


def suffer(programs: Programs, whole: Programs, asked: list[Query]) -> tuple[str, int]:
    """The fate of a mutant at the first query that it does not survive, and the number of that
    query; no fate if the programs without it do not survive that either. A query that takes too
    long ends the process."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    for number, query in enumerate(asked):
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        try:
            fate = tried(programs[query.files], query)
        except MemoryError:
            return "endless", number
        if fate != "survived":
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            right = tried(whole[query.files], query) == "survived"
            return fate if right else "", number
    return "survived", -1


WORD = re.compile(r"\b[a-z0-9]\w*")
NAME = re.compile(r"\b[a-z]\w+")  # not t, the step of the program parts
DEFINED = re.compile(r"#defined [^.]*\.")
MANY = 9  # rules of one predicate, such as needs/1: what they ask for has little to do with it


def words(query: Query) -> frozenset[str]:
    """The names and numbers in what a query gives and loads: predicates, constants, terms and
    files; and the program parts that are grounded with its steps."""
    facts = DEFINED.sub("", query.facts)
    given = facts, *query.steps, *query.arguments, *query.files
    return frozenset(WORD.findall(" ".join(given))) | {f"#program {part}" for part in query.parts}


def concerned(mutant: Mutant, among: Sequence[str], others: Iterable[str]) -> dict[str, float]:
    """How much each name has to do with the rule of a mutant: 1 for the names in the rule and for
    its program part, a quarter for its numbers; half of 1 for those of the statements that define
    what its body asks for, or ask for what it defines; and so on, by half, for those that define
    what these ask for. ``among`` is what its file states, and ``others`` what is loaded with it."""
    found = {word: 0.25 if word.isdecimal() else 1.0 for word in WORD.findall(mutant.rule)}
    parts = [text for text in among[: mutant.number] if text.startswith("#program")]
    found |= {part.partition("(")[0]: 1.0 for part in parts[-1:]}
    near = ends(mutant.rule)
    waiting = [ends(text) for text in {*among, *others} if not text.startswith("#d")]
    rules_of = Counter(name for defined, _ in waiting for name in defined)
    heads, asked, weight = near[0], near[1], 0.5
    while True:
        asked = {name for name in asked if rules_of[name] < MANY}
        come = [two for two in waiting if asked & two[0] or heads & two[1]]
        if not come:
            return found
        waiting = [two for two in waiting if two not in come]
        names = frozenset().union(*(one | other for one, other in come))
        found = dict.fromkeys(names, weight) | found
        asked, heads = frozenset().union(*(other for _, other in come)), frozenset()
        weight /= 2


@cache
def ends(rule: str) -> tuple[frozenset[str], frozenset[str]]:
    """The names in the head of a rule, and in its body, without numbers."""
    head, _, body = rule.partition(" :- ")
    return frozenset(NAME.findall(head)), frozenset(NAME.findall(body))


class Order:
    """The order in which a mutant is asked. Four orders take turns: what settled it ``before``,
    then what settled most mutants of the same rule, of the same file, and of all; what gives most
    of what the rule is about and few others give; the same, by turns of each set of files that is
    loaded, the smallest sets first; and an order at random, as queries that one of the others puts
    together are much alike."""

    def __init__(self, asked: Sequence[Query], before: Mapping[Mutant, str]) -> None:
        self.names = [name_of(query) for query in asked]
        self.words = [words(query) for query in asked]
        self.files = [query.files for query in asked]
        self.before = before
        self.settlers: dict[tuple[str, ...], Counter[str]] = defaultdict(Counter)
        for mutant, name in before.items():
            self.settled(mutant, name)

    def settled(self, mutant: Mutant, name: str) -> None:
        """A query of this name settled the mutant."""
        for among in (mutant.file, mutant.rule), (mutant.file,), ():
            self.settlers[among][name] += 1

    def of(
        self,
        mutant: Mutant,
        loading: dict[int, int],
        among: Sequence[str],
        others: Iterable[str] = (),
    ) -> list[int]:
        """These queries in that order, by number, each with how many files it loads, given in an
        order at random; ``among`` is what the file of the mutant states, and ``others`` what is
        loaded with it."""
        topics = concerned(mutant, among, others)
        often = Counter(word for number in loading for word in topics.keys() & self.words[number])
        # A predicate is said to be defined for those that do not give it.
        sign = -1 if mutant.rule.startswith("#defined") else 1
        of_rule = self.settlers[mutant.file, mutant.rule]
        of_file, of_all = self.settlers[mutant.file,], self.settlers[()]
        told = {
            number: sign
            * sum(
                topics[word] * math.log(len(loading) / often[word])
                for word in topics.keys() & self.words[number]
            )
            for number in loading
        }

        def settled(number: int) -> tuple[int, ...]:
            name = self.names[number]
            return name == self.before.get(mutant), of_rule[name], of_file[name], of_all[name]

        by_topic = sorted(loading, key=told.__getitem__, reverse=True)
        before: Counter[tuple[str, ...]] = Counter()
        place = {}
        for number in by_topic:
            files = self.files[number]
            place[number] = before[files], loading[number]
            before[files] += 1
        of_others = sorted(loading, key=settled, reverse=True)
        orders = of_others, by_topic, sorted(loading, key=place.__getitem__)
        turns = zip(*orders, loading, strict=True)
        return list(dict.fromkeys(number for turn in turns for number in turn))


def fates(
    folder: Path,
    chosen: list[Mutant],
    asked: list[Query],
    measured: list[Query],
    jobs: int,
    proved: Container[Key] = (),
    before: Mapping[Mutant, str] = MappingProxyType({}),
    most: int = QUERIES,
) -> Iterator[Tried]:
    """The fate of each mutant, as they come, each in a process of its own; the ``proved`` ones come
    last, as none of them should be settled. ``before`` has the name of the query that settled a
    mutant once. A mutant that survives ``most`` queries, and is not larger, has survived if it is
    one of the ``proved`` ones, and else is asked all the others."""
    loaded = sets(folder, asked + measured)
    order = Order(asked, before)
    names = set().union(*loaded.values())
    texts = {file: list(map(str, statements(folder, file))) for file in names}

    def program(files: tuple[str, ...]) -> str:
        return whole_program(texts[name] for name in loaded[files])

    whole = {files: program(files) for files in loaded}
    lean = {file for query in measured for file in loaded[query.files]}
    some = any(mutant.file in lean for mutant in chosen)
    least = [(query, rules(whole[query.files], query)) for query in measured if some]
    waiting = chosen[::-1]
    waiting.sort(key=lambda mutant: mutant.key not in proved)
    running: dict[int, tuple[Mutant, int]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                mutant = waiting.pop()
                result, told = os.pipe()
                if child := os.fork():
                    os.close(told)
                    running[child] = mutant, result
                    continue
                code = 1
                try:
                    loading = {
                        number: len(loaded[query.files])
                        for number, query in enumerate(asked)
                        if mutant.file in loaded[query.files]
                    }
                    together = set().union(
                        *(every for every in loaded.values() if mutant.file in every)
                    )
                    others = [text for name in sorted(together) for text in texts[name]]
                    mine = order.of(mutant, loading, texts[mutant.file], others)
                    texts[mutant.file][mutant.number] = mutant.text
                    mutated = {
                        files: program(files)
                        for files, every in loaded.items()
                        if mutant.file in every
                    }
                    questions = [asked[number] for number in mine[:most]]
                    fate, number = suffer(mutated, whole, questions)
                    if fate == "survived" and mutant.file in lean:
                        signal.setitimer(signal.ITIMER_PROF, SECONDS * len(measured))
                        differences = (
                            rules(mutated[query.files], query) - number
                            for query, number in least
                            if query.files in mutated
                        )
                        try:
                            first = next((more for more in differences if more), 0)
                            fate = "larger" if first > 0 else fate
                        except (MemoryError, RuntimeError):  # clingo is out of memory
                            fate = "endless"
                    if fate == "survived" and mutant.key not in proved:
                        rest = [asked[place] for place in mine[most:]]
                        fate, number = suffer(mutated, whole, rest)
                        number += most if number >= 0 else 0
                    settled = order.names[mine[number]] if number >= 0 else str(most)
                    os.write(told, f"{fate or 'wrong'} {settled}".encode())
                    code = 0
                except MemoryError:  # where the encodings were asked without the change, say
                    os.write(told, b"endless -")
                    code = 0
                finally:
                    os._exit(code)
            child, status = os.wait()
            mutant, result = running.pop(child)
            with os.fdopen(result, encoding="utf-8") as words:
                fate, _, query = words.read().partition(" ")
            code = os.waitstatus_to_exitcode(status)
            if fate == "wrong":
                raise InputError(f"{mutant.file}: a query has a wrong answer without a change")
            if code > 0:  # seen where clingo had no memory left
                print(f"mutate: its process failed: {mutant}", file=sys.stderr)
            if code:
                fate, query = "endless", "-"
            order.settled(mutant, query)
            yield Tried(mutant, fate, query)
    finally:
        for child, (_, result) in running.items():
            os.close(result)
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)


def marks(
    folder: Path, chosen: list[Mutant], asked: list[Query], measured: list[Query]
) -> Callable[[Mutant, str], str]:
    """A function that gives a mark of a mutant and what settled it: of the mutant, and of the query
    of this name with all that it loads, or else of all queries."""
    loaded = sets(folder, asked + measured)
    texts = {
        name: repr(list(map(str, statements(folder, name))))
        for name in set().union(*loaded.values())
    }
    of_files = {
        files: hashlib.sha256(repr((files, [texts[name] for name in every])).encode()).hexdigest()
        for files, every in loaded.items()
    }
    names = [(name_of(query), query.files) for query in asked + measured]
    asked_of = dict(names[: len(asked)])
    settled = clingo.__version__, SECONDS, BYTES
    of_file = {}
    for file in {mutant.file for mutant in chosen}:
        told = [of_files[files] for files, every in loaded.items() if file in every]
        told += [name for name, files in names if file in loaded[files]]
        of_file[file] = hashlib.sha256(repr(sorted(told)).encode()).hexdigest()

    def mark(mutant: Mutant, query: str) -> str:
        files = asked_of.get(query)
        told = of_file[mutant.file] if files is None else of_files[files] + query
        found = settled, told, mutant.file, mutant.number, mutant.text
        return hashlib.sha256(repr(found).encode()).hexdigest()

    return mark


def going_on(
    path: Path,
    chosen: list[Mutant],
    mark: Callable[[Mutant, str], str],
    trials: Trials,
    proved: Container[Key] = (),
    most: int = QUERIES,
    minutes: float = math.inf,
) -> Iterator[Tried]:
    """The fates that a file knows already, then those of the others, which are added to it; after
    these minutes, the rest is untried.

    A line of the file has a digest of the rule and the change of a mutant, its mark, its fate
    and the query that settled it, or how many it was asked; the last line of a mutant counts. If
    its mark is another one by now, that query is asked first: as a rule it settles the mutant
    again. A further query leaves the mark of what another one settled as it is. A survivor that is
    none of the ``proved`` ones is tried again."""
    known = {}
    if path.exists():
        for line in path.read_text().splitlines():
            key, *rest = line.split()
            known[key] = rest
    keys = {
        mutant: hashlib.sha256(repr((*mutant.key, mutant.text)).encode()).hexdigest()[:16]
        for mutant in chosen
    }
    left, before = [], {}
    for mutant, key in keys.items():
        at, fate, query = known.get(key, ("", "", "-"))
        before[mutant] = query
        enough = fate != "survived" or (mutant.key in proved and int(query) >= most)
        if at == mark(mutant, query) and enough:
            yield Tried(mutant, fate, query)
            continue
        left.append(mutant)
    path.parent.mkdir(parents=True, exist_ok=True)
    late = time.monotonic() + 60 * minutes
    untried = dict.fromkeys(left)
    with path.open("a") as file:
        for one in trials(left, before):
            line = keys[one.mutant], mark(one.mutant, one.query), one.fate, one.query
            file.write(" ".join(line) + "\n")
            file.flush()
            del untried[one.mutant]
            yield one
            if time.monotonic() > late:
                break
    yield from (Tried(mutant, UNTRIED, "-") for mutant in untried)


def listed(path: Path) -> dict[Key, str]:
    """The mutants that a file lists as equivalent, each with the reason: of an entry, every
    change of every rule in every file that it names."""

    def several(value: str | list[str]) -> list[str]:
        return [value] if isinstance(value, str) else value

    try:
        found = {}
        for entry in tomllib.loads(path.read_text(encoding="utf-8"))["equivalent"]:
            named = several(entry["file"]), several(entry["rule"]), entry["changes"]
            for key in product(*named):
                found[key] = entry["reason"].strip()
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: {error!r}") from None
    return found


def report(
    fate: dict[Mutant, str], reasons: dict[Key, str], most: int, every: int, sizes_asked: int
) -> str:
    """The text of docs/mutation.md, of mutants that were asked ``most`` queries out of so many."""

    def row(name: str, group: list[Mutant]) -> str:
        kinds = Counter(mutant.kind for mutant in group)
        ends = Counter(fate[mutant] for mutant in group)
        proved = sum(fate[mutant] == "survived" and mutant.key in reasons for mutant in group)
        ends["survived"] -= proved
        numbers = [*(kinds[kind] for kind in KINDS), len(group), *(ends[end] for end in FATES)]
        return f"| {name} | {' | '.join(map(str, [*numbers, proved]))} |"

    rows = [row(f"`{file}.lp`", list(group)) for file, group in groupby(fate, lambda m: m.file)]
    for name, stated in ("`paper/`", True), ("all but `paper/`", False):
        group = [mutant for mutant in fate if mutant.file.startswith("paper/") == stated]
        rows.append(row(name, group))
    lines = [
        HEAD.format(
            clingo=clingo.__version__,
            python=platform.python_version(),
            seconds=SECONDS,
            memory=BYTES >> 20,
            most=most,
            all=every,
            sizes=sizes_asked,
        ),
        f"| encoding | {' | '.join((*KINDS, 'all', *FATES, 'equivalent'))} |",
        "|---|" + "--:|" * (len(KINDS) + len(FATES) + 2),
        *(*rows, row("all", list(fate))),
        "\n## Mutants that give no wrong answer\n",
    ]
    survivors = [mutant for mutant in fate if fate[mutant] == "survived"]
    for (file, rule), group in groupby(survivors, lambda mutant: (mutant.file, mutant.rule)):
        lines.append(f"`{file}.lp`: `{rule}`\n")
        for reason, same in groupby(group, lambda m: reasons.get(m.key, "**Not listed.**")):
            changed = "; ".join(f"`{mutant.change}`" for mutant in same)
            lines.append(f"- {changed}: {reason}")
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def count(text: str) -> int:
    """A number from 1, of the command line."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1")
    return int(text)


def faults(fate: dict[Mutant, str], reasons: dict[Key, str], known: set[Key]) -> Iterator[str]:
    """What is wrong with the fates, or with the list of the equivalent mutants."""
    for mutant, end in fate.items():
        if end == "survived" and mutant.key not in reasons:
            yield f"survives, not listed: {mutant}"
        if end == UNTRIED:
            yield f"not tried: {mutant}"
        elif end != "survived" and mutant.key in reasons:
            yield f"listed, but {end}: {mutant}"
    for key in reasons:
        if key not in known:
            yield f"listed, but no mutant: {' | '.join(key)}"


def main(
    argv: list[str] | None = None,
    folder: Path = ENCODINGS,
    asked: Callable[[], list[Query]] = queries,
    measured: Callable[[], list[Query]] = sizes,
) -> int:
    parser = argparse.ArgumentParser(description="Try the mutants of the encodings.")
    parser.add_argument("-j", "--jobs", type=count, default=1, help="processes")
    parser.add_argument("--sample", type=count, help="try only so many, none listed; no report")
    parser.add_argument("--seed", default="0", help="of the sample")
    parser.add_argument("--listed", type=Path, default=LISTED, help="the equivalent mutants")
    parser.add_argument("--report", type=Path, default=REPORT, help="the file to write")
    parser.add_argument("--known", type=Path, help="a file that keeps what was tried, to go on")
    parser.add_argument(
        "--queries",
        metavar="N",
        type=count,
        default=QUERIES,
        help="ask a listed mutant at most N queries, and others so many before their size is taken "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--minutes",
        type=count,
        default=math.inf,
        help="with --known: leave untried what was not tried after so many minutes",
    )
    parser.add_argument("files", nargs="*", help="try only these, as theory/links; no report")
    options = parser.parse_args(argv)
    if options.minutes < math.inf and not options.known:
        parser.error("--minutes needs --known, where the next run finds what was tried")
    names = named_files(folder)
    try:
        if unknown := set(options.files) - set(names):
            raise InputError(f"{', '.join(sorted(unknown))}: no such encoding")
        reasons = listed(options.listed)
        everyone = [mutant for file in names for mutant in mutants(folder, file)]
        loaded = sets(folder, asked()).items()
        for file in dict.fromkeys(mutant.file for mutant in everyone):
            if not any(file in every for _, every in loaded):
                raise InputError(f"{file}: no query in tests/oracles/known_answers.py loads it")
        chosen = [mutant for mutant in everyone if mutant.file in (options.files or names)]
        if options.sample:
            chosen = [mutant for mutant in chosen if mutant.key not in reasons]
            chosen = random.Random(options.seed).sample(chosen, min(options.sample, len(chosen)))

        def trials(left: list[Mutant], before: dict[Mutant, str]) -> Iterator[Tried]:
            how = options.jobs, reasons, before, options.queries
            return fates(folder, left, asked(), measured(), *how)

        found = trials(chosen, {})
        if options.known:
            mark = marks(folder, chosen, asked(), measured())
            how = mark, trials, reasons, options.queries, options.minutes
            found = going_on(options.known, chosen, *how)
        ends = {one.mutant: one.fate for one in tqdm(found, "mutants", len(chosen), disable=None)}
        fate = {mutant: ends[mutant] for mutant in chosen}
        if not (options.files or options.sample):
            with output(str(options.report)) as text:
                text.write(report(fate, reasons, options.queries, len(asked()), len(measured())))
    except InputError as error:
        print(f"mutate: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    numbers = Counter(fate.values())
    print(f"{len(fate)} mutants:", ", ".join(f"{numbers[end]} {end}" for end in FATES))
    wrong = list(faults(fate, reasons, {mutant.key for mutant in everyone}))
    for fault in wrong:
        print(fault)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
