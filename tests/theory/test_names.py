"""One name, one meaning: the glossary of encodings/README.md against the files."""

import re
from collections import defaultdict

import pytest
from clingo import ast
from conftest import ENCODINGS
from oracles.rule_mutation import closure, named_files, statements

ROW = re.compile(r"^\| `(\w+)(?:\(([^)]*)\))?` \| (.+?) \| (.+?) \|$", re.MULTILINE)
MARKER = {"drop", "pick", "marker"}  # their second arity names one of several markers
MOST, BEYOND = 45, 45  # rules of the statement, and of what lies beyond it


def glossary():
    """The rows: name and number of arguments, meaning, files."""
    text = (ENCODINGS / "README.md").read_text(encoding="utf-8")
    rows = ROW.findall(text)
    assert len(rows) > 200
    for name, arguments, meaning, files in rows:
        number = len(arguments.split(",")) if arguments else 0
        yield (name, number), meaning, set(re.findall(r"`([\w/]+)`", files))


class Atoms(ast.Transformer):
    """The predicates of the atoms that it meets."""

    def __init__(self):
        self.found = set()

    def visit_SymbolicAtom(self, node):
        terms = [node.symbol]
        while terms:
            term = terms.pop()
            if term.ast_type == ast.ASTType.Pool:
                terms += term.arguments
            elif term.ast_type == ast.ASTType.UnaryOperation:
                terms.append(term.argument)
            else:
                self.found.add((term.name, len(term.arguments)))
        return node


class Heads(Atoms):
    """Those of heads: of a choice, without the conditions."""

    def visit_ConditionalLiteral(self, node):
        self.visit(node.literal)
        return node


def predicates():
    """Each predicate, with the files that derive it."""
    found = defaultdict(set)
    for file in named_files(ENCODINGS):
        for statement in statements(ENCODINGS, file):
            every, heads = Atoms(), Heads()
            every.visit(statement)
            if statement.ast_type == ast.ASTType.Rule:
                heads.visit(statement.head)
            for name in every.found:
                found[name] |= {file} if name in heads.found else set()
    return found


def test_the_glossary_has_each_predicate_and_where_it_is_derived():
    rows = list(glossary())
    assert len({name for name, *_ in rows}) == len(rows)
    assert {name: files for name, _, files in rows} == dict(predicates())


def test_a_name_has_one_number_of_arguments():
    numbers = defaultdict(set)
    for name, number in predicates():
        numbers[name].add(number)
    assert {name: n for name, n in numbers.items() if len(n) > 1 and name not in MARKER} == {}


@pytest.mark.parametrize("file", named_files(ENCODINGS))
def test_what_a_head_lists_is_in_the_glossary(file):
    """Each predicate that the head of a file lists as its output is derived there, or in a file
    that it includes."""
    text = (ENCODINGS / f"{file}.lp").read_text(encoding="utf-8")
    head = re.match(r"(%.*\n)+", text).group()
    output = re.search(r"^% Output.*?(?=^% [A-Z-]|\Z)", head, re.MULTILINE | re.DOTALL)
    rows = {name: files for name, _, files in glossary()}
    loaded = set(closure(ENCODINGS, (file,)))
    for line in output.group().splitlines() if output else []:
        start = re.match(r"^%(?: Output: {1,2}| {10}| {3})(\w+)(?:\((.*?)\))? {2,}\S", line)
        if start:
            name = start[1], re.sub(r"\([^()]*\)", "", start[2] or "").count(",") + bool(start[2])
            assert name in rows, line
            assert rows[name] & loaded, line


def count(files):
    kinds = (ast.ASTType.Rule, ast.ASTType.Minimize)
    every = [statement for file in files for statement in statements(ENCODINGS, file)]
    return sum(statement.ast_type in kinds for statement in every)


def test_the_paper_is_stated_in_forty_five_rules():
    files = [file for file in named_files(ENCODINGS) if file.startswith("paper/")]
    beyond = [file for file in files if file.startswith("paper/beyond/")]
    assert 30 < count(set(files) - set(beyond)) <= MOST
    assert 0 < count(beyond) <= BEYOND
