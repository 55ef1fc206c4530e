"""The docstrings of the public names: parameters, returns and errors, in one style.

ruff's rules D hold the rest: that there is a docstring, with a summary in one line.
"""

import ast
import builtins
import inspect
import re
import textwrap

import pytest
import topomap
from topomap.runtime.watch import Stopped

SECTION = re.compile(r"^(\w+):\n((?:    .*\n?|\n)+)", re.MULTILINE)
ENTRY = re.compile(r"^    (\w+): (.+)$", re.MULTILINE)
KNOWN = ("Parameters", "Returns", "Yields", "Raises", "Attributes")
OWN = {"InputError": topomap.InputError, "Stopped": Stopped}


def public():
    """The public functions, and the methods of the public classes, by their names."""
    for name in topomap.__all__:
        thing = getattr(topomap, name)
        if inspect.isclass(thing):
            for method, made in vars(thing).items():
                plain = made.__func__ if isinstance(made, classmethod | staticmethod) else made
                told = inspect.isfunction(plain) and plain.__doc__
                if told and (method == "__init__" or not method.startswith("_")):
                    yield f"{name}.{method}", plain
        elif inspect.isfunction(thing):
            yield name, thing


PUBLIC = dict(public())


def sections(thing):
    """The sections of a docstring: the text of each by its name."""
    text = inspect.getdoc(thing)
    found = dict(SECTION.findall(text))
    heads = re.findall(r"^(\w+):$", text, re.MULTILINE)
    assert [*found] == heads == sorted(heads, key=KNOWN.index)
    return found


def entries(section):
    return [name for name, _ in ENTRY.findall(section)]


def test_there_are_public_names():
    """Each public class has the methods that it is used by."""
    assert {"solve", "ask", "generate", "Map.draw", "Answer.close", "Experience.facts"} <= {*PUBLIC}
    assert len(PUBLIC) > 35


@pytest.mark.parametrize("name", PUBLIC)
def test_each_parameter_is_described_and_no_other(name):
    thing = PUBLIC[name]
    names = [one for one in inspect.signature(thing).parameters if one != "self"]
    assert entries(sections(thing).get("Parameters", "")) == names


@pytest.mark.parametrize("name", PUBLIC)
def test_what_is_returned_is_described(name):
    thing = PUBLIC[name]
    returned = inspect.signature(thing).return_annotation
    told = {"Returns", "Yields"} & sections(thing).keys()
    assert len(told) == (returned not in (None, "None", inspect.Signature.empty))


@pytest.mark.parametrize("name", PUBLIC)
def test_errors_are_described(name):
    """Each is an exception; and those are among them that the function itself raises."""
    thing = PUBLIC[name]
    told = entries(sections(thing).get("Raises", ""))
    for error in told:
        found = OWN.get(error) or getattr(builtins, error)
        assert issubclass(found, BaseException), error
    tree = ast.parse(textwrap.dedent(inspect.getsource(thing)))
    raised = {
        node.exc.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Raise)
        and isinstance(node.exc, ast.Call)
        and isinstance(node.exc.func, ast.Name)
    }
    assert raised <= {*told}


@pytest.mark.parametrize("name", PUBLIC)
def test_entries_are_sentences(name):
    """They begin with a capital or a name, and end with a full stop. What is returned begins with
    no colon, before which tools would take the words for a type."""
    for head, section in sections(PUBLIC[name]).items():
        whole = textwrap.dedent(section).strip()
        for entry in [whole] if head in ("Returns", "Yields") else re.split(r"\n(?! )", whole):
            told = " ".join(entry.split())
            text = told.partition(": ")[2] if head in ("Parameters", "Raises") else told
            assert re.match(r"[A-Z`]", text), entry
            assert re.search(r"\.\)?$", text), entry
            assert head != "Returns" or not re.match(r"[\w ]+: ", text), entry


@pytest.mark.parametrize(
    "name", ["solve", "ask", "explain", "explore", "count", "follow", "simulate", "check"]
)
def test_units_and_sources_are_stated(name):
    text = " ".join(inspect.getdoc(PUBLIC[name]).split())
    assert re.search(r"timeout: .*seconds", text)
    assert "the paper" in text
