"""The habits of the command: completion, manual pages, hints, defaults, and what is cited."""

import argparse
import re
import shlex
import shutil
import subprocess
from datetime import date

import pytest
import topomap
import yaml
from conftest import ROOT
from topomap.cli import SUBCOMMANDS, main, whole_parser
from topomap.cli.arguments import parsers
from topomap.cli.completion import SHELLS, script
from topomap.cli.manual import pages
from topomap.runtime import extras

GRID = "instances/grid-3x3-snake.lp"


# Completion


@pytest.fixture(scope="module")
def bash(tmp_path_factory):
    """A file with the script for bash."""
    file = tmp_path_factory.mktemp("completion") / "topomap.bash"
    file.write_text(script("bash"))
    return file


def completed(bash, folder, *words):
    """What bash offers for the last word of a call, in a folder."""
    line = " ".join(map(shlex.quote, words))
    program = (
        f"source {shlex.quote(str(bash))}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}\n"
        'read -ra how <<<"$(complete -p topomap)"\n'
        "for n in ${!how[@]}; do [ ${how[n]} = -F ] && call=${how[n + 1]}; done\n"
        f"$call topomap {shlex.quote(words[-1])} {shlex.quote(words[-2])}\n"
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    call = ["bash", "--norc", "-c", program]
    done = subprocess.run(call, capture_output=True, text=True, cwd=folder, check=True)
    assert not done.stderr
    return {word.strip() for word in done.stdout.splitlines()} - {""}


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (["so"], {"solve"}),
        (["ex"], {"explain", "explore", "export"}),
        (["solve", "--opt"], {"--optimal"}),
        (["solve", "walk.lp", "--encoding", ""], {"work", "paper"}),
        (["generate", "tor"], {"torus"}),
        (["generate", "grid", "--rou"], {"--route"}),
        (["export", "--format", "graph"], {"graphml"}),
    ],
)
def test_bash_completes_commands_options_and_values(bash, tmp_path, words, offered):
    assert completed(bash, tmp_path, "topomap", *words) == offered


@pytest.mark.parametrize(
    "words",
    [
        ["solve", ""],
        ["solve", "walk.lp", "--truth", ""],
        ["solve", "walk.lp", "-o", ""],
        ["validate", ""],
        ["draw", "walk.lp", "--like", ""],
        ["family", ""],
        ["generate", "world", ""],
        ["explore", "walk.lp", "--among", ""],
        ["import", ""],
    ],
)
def test_bash_completes_files_where_files_are_wanted(bash, tmp_path, words):
    for name in ("walk.lp", "city.graphml"):
        (tmp_path / name).touch()
    (tmp_path / "folder").mkdir()
    offered = completed(bash, tmp_path, "topomap", *words)
    assert {"walk.lp", "city.graphml", "folder"} <= {word.rstrip("/") for word in offered}
    assert completed(bash, tmp_path, "topomap", *words[:-1], "cit") == {"city.graphml"}


def test_bash_completes_folders_where_folders_are_wanted(bash, tmp_path):
    (tmp_path / "walk.lp").touch()
    (tmp_path / "folder").mkdir()
    offered = completed(bash, tmp_path, "topomap", "figures", "-d", "")
    assert {word.rstrip("/") for word in offered} == {"folder"}
    assert completed(bash, tmp_path, "topomap", "solve", "walk.lp", "--bound", "") == set()


@pytest.mark.parametrize("shell", SHELLS)
def test_a_script_for_each_shell_is_printed(inside, tmp_path, shell):
    done = inside("--print-completion", shell)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == script(shell) + "\n"
    assert all(name in done.stdout for name in SUBCOMMANDS)
    if program := shutil.which(shell):
        (file := tmp_path / "script").write_text(done.stdout)
        subprocess.run([program, "-n", file], check=True)


def test_completion_says_in_one_line_what_it_lacks(inside, monkeypatch):
    monkeypatch.setattr(extras, "find_spec", lambda module: None)
    done = inside("--print-completion", "bash")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("topomap --print-completion: shtab is not installed; it comes")
    assert "pip install '.[complete]'" in done.stderr


# Manual pages

MACROS = {".TH", ".SH", ".SS", ".TP", ".PP", ".nf", ".fi"}


def test_there_is_a_manual_page_for_each_command():
    assert {*pages()} == {"topomap.1", *(f"topomap-{name}.1" for name in SUBCOMMANDS)}


def test_manual_pages_tell_what_help_tells():
    made = {name: unescaped(page) for name, page in pages().items()}
    seen = 0
    for parser in parsers(whole_parser()):
        name = "-".join(parser.prog.split()[:2]) + ".1"
        assert " ".join((parser.description or "").split()) in made[name]
        for action in parser._actions:
            assert all(option in made[name] for option in action.option_strings)
            if action.help and not isinstance(action, argparse._SubParsersAction):
                seen += 1
                told = parser._get_formatter()._expand_help(action)
                assert " ".join(told.split()) in made[name]
        for line in (parser.epilog or "").splitlines():
            assert line.removeprefix("exit status:").strip() in made[name] or line == "example:"
    assert seen > 300


def unescaped(page):
    return re.sub(r"^\\&", "", page, flags=re.MULTILINE).replace("\\-", "-").replace("\\e", "\\")


@pytest.mark.parametrize("name", pages())
def test_manual_pages_are_roff(name):
    """Each request is a macro of man(7); and groff and mandoc have nothing to say, if there."""
    page = pages()[name]
    requests = re.findall(r"^[.'].*$", page, re.MULTILINE)
    assert {request.split()[0] for request in requests} <= MACROS
    sections = [request[4:] for request in requests if request.startswith(".SH ")]
    assert sections[:3] == ["NAME", "SYNOPSIS", "DESCRIPTION"]
    assert sections[-1] == "SEE ALSO"
    for call in (
        ["groff", "-man", "-ww", "-Tascii", "-z"],
        ["mandoc", "-Tlint", "-Wwarning"],
    ):
        if shutil.which(call[0]):
            done = subprocess.run(call, input=page, capture_output=True, text=True)
            assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_make_writes_the_manual_pages(tmp_path):
    makefile = (ROOT / "Makefile").read_text()
    assert "$(BIN)/python -m topomap.cli.manual build/man\n" in makefile
    from topomap.cli.manual import main as write

    write(str(tmp_path / "man"))
    assert {path.name for path in (tmp_path / "man").iterdir()} == {*pages()}


# Hints


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (["sovle", GRID], "topomap: no such command: 'sovle' (did you mean solve? see"),
        (["generate", "gird", "2", "3"], "invalid choice: 'gird' (did you mean grid? choose from"),
        (["solve", GRID, "--plannar"], "--plannar (did you mean --planar? see"),
        (["solve", GRID, "--optimall"], "--optimall (did you mean --optimal? see"),
        (["solve", GRID, "--encoding", "wrok"], "'wrok' (did you mean work? choose from"),
        (["export", GRID, "--format", "graphlm"], "'graphlm' (did you mean graphml? choose"),
        (["generate", "grid", "2", "2", "--roote", "E"], "--route (did you mean --route? see"),
        (["ask", GRID, "plannar"], "plannar: no such word; did you mean planar?"),
        (["ask", GRID, "place < 3"], "place: not a number of a map; did you mean places?"),
        (["explore", GRID, "--among", "optimall"], "did you mean optimal?"),
        (["--print-completion", "bsh"], "'bsh' (did you mean bash? choose from bash, zsh, tcsh)"),
    ],
)
def test_misspelt_words_are_asked_back(inside, words, hint):
    done = inside(*words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert hint in done.stderr


@pytest.mark.parametrize(
    "words", [["xyzzy"], ["solve", GRID, "--xyzzy"], ["solve", GRID, "--encoding", "xyzzy"]]
)
def test_words_that_are_like_no_other_are_only_refused(inside, words):
    done = inside(*words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "did you mean" not in done.stderr


def test_python_asks_back_too():
    with pytest.raises(ValueError, match=r"'gird' is not one of the environments .*mean grid\?"):
        topomap.generate("gird", 2, 3, route="E")


# Defaults


def valued():
    """The arguments of all commands that take a value and can be left out."""
    for parser in parsers(whole_parser()):
        for action in parser._actions:
            takes = not isinstance(action, argparse._SubParsersAction) and action.nargs != 0
            if takes and not action.required:
                yield parser, action


def test_each_default_is_stated_in_the_help():
    """By its value, where the parser has one; else by what is done."""
    stated = 0
    for parser, action in valued():
        default = parser.get_default(action.dest)
        if default in (None, (), []):
            continue
        told = " ".join(parser._get_formatter()._expand_help(action).split())
        value = f"{default:g}" if isinstance(default, float) else str(default)
        words = {"-": "standard input"}.get(value, value)
        from_where = told if f"(default: {words}" in told else described(parser, words)
        assert f"default: {words}" in from_where, f"{parser.prog} {action.option_strings}"
        stated += 1
    assert stated > 20


def described(parser, words):
    """The description, where it tells a default, and no argument does."""
    return parser.description if f"--timeout (default: {words})" in parser.description else ""


def test_an_option_with_a_value_says_what_is_done_without_it():
    """Options with a number, and all those for which the parser has no default."""
    numbers = without = 0
    for parser, action in valued():
        none = parser.get_default(action.dest) is None
        if action.option_strings and (none or action.type is not None):
            numbers += action.type is not None
            without += none and action.type is None
            told = action.help + (
                parser.description if "--timeout" in action.option_strings else ""
            )
            assert "default:" in told, f"{parser.prog} {action.option_strings}"
    assert numbers > 100
    assert without > 100


# Versions, and how to cite


def citation():
    return yaml.safe_load((ROOT / "CITATION.cff").read_text())


def versions():
    """The versions of CHANGES.md, the newest first, each with its date or "unreleased"."""
    text = (ROOT / "CHANGES.md").read_text()
    return re.findall(r"^## (\d+\.\d+\.\d+) \((\S+)\)$", text, re.MULTILINE)


def test_the_citation_is_of_this_version():
    (version, day), *_ = versions()
    assert citation()["version"] == version == topomap.__version__
    released = citation().get("date-released")
    assert (released is None) == (day == "unreleased")
    assert released is None or str(released) == day


def test_the_bibtex_entries_are_those_of_the_citation():
    text = (ROOT / "docs/first-questions.md").read_text()
    known = citation()
    (paper,) = known["references"]
    assert f"version = {{{known['version']}}}" in text
    for one in (known, paper):
        assert f"{{{one['title']}}}" in text
    years = str(known["date-released"])[:4], paper["year"]
    for year in years:
        assert f"= {{{year}}}" in text
    for author in paper["authors"]:
        assert f"{author['family-names']}, {author['given-names']}" in text


def test_the_changes_are_by_version_with_the_newest_first():
    numbers = [tuple(map(int, version.split("."))) for version, _ in versions()]
    assert numbers == sorted({*numbers}, reverse=True)
    assert len(numbers) == (ROOT / "CHANGES.md").read_text().count("\n## ")
    days = [date.fromisoformat(day) for _, day in versions() if day != "unreleased"]
    assert days == sorted(days, reverse=True)
    assert all(day != "unreleased" for _, day in versions()[1:])


def test_a_tag_is_the_version_of_its_commit():
    """Where git and the tags are there: the tag vX.Y.Z is a version of CHANGES.md, and its commit
    has this version."""
    if not shutil.which("git") or not (ROOT / ".git").exists():
        pytest.skip("no repository")
    git = ["git", "-C", str(ROOT)]
    tags = subprocess.run([*git, "tag", "--list", "v*"], capture_output=True, text=True)
    for tag in tags.stdout.split():
        assert tag[1:] in dict(versions())
        shown = subprocess.run(
            [*git, "show", f"{tag}:CITATION.cff"], capture_output=True, text=True, check=True
        )
        assert str(yaml.safe_load(shown.stdout)["version"]) == tag[1:]


def test_the_page_for_contributors_is_short_and_links_on():
    text = (ROOT / "CONTRIBUTING.md").read_text()
    assert len(text.splitlines()) <= 60
    for link in re.findall(r"\]\(([^)#:]+)\)", text):
        assert (ROOT / link).exists(), link
    assert "](docs/DEVELOPMENT.md)" in text
    targets = set(re.findall(r"\bmake ([a-z-]+)", text))
    assert targets
    assert targets <= set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.M))


def test_help_of_all_commands_is_printed(capsys):
    for parser in parsers(whole_parser()):
        if parser.prog.split()[1:] != ["clingo"]:
            assert main([*parser.prog.split()[1:], "--help"]) == 0
            assert capsys.readouterr().out.startswith(f"usage: {parser.prog} ")
