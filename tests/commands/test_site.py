"""The site that ``make docs`` makes: what is generated, and the built site, by itself and in a
browser that searches it."""

import argparse
import html
import json
import re
import subprocess
import threading
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import unquote, urldefrag, urlsplit

import pytest
import topomap
from conftest import BIN, ROOT, run
from website import commands, encodings, links, theory

PAPER = ROOT / "encodings/paper"
FIRST = (ROOT / "docs/first-questions.md").read_text()
# What somebody types who has the question; and words of the answer, on the page that is found.
QUESTIONS = {
    "How do I write my log down?": ("write log", "each step"),
    'What does "optimal" mean?': ("optimal", "fewest paths"),
    "Why a triangle and not a square?": ("triangle square", "whose sides bend"),
    "How do I install it without make?": ("install without make", "pip install '.[draw]'"),
    "How do I get the map as a networkx graph?": ("networkx", "to_networkx"),
    "Which maps are planar?": ("planar maps", "genus"),
    "What should I cite?": ("cite", "CITATION.cff"),
    "Is it exact?": ("exact", "every"),
    "How large can a problem be?": ("how large", "steps"),
    "How do I read `at(9,3,2)`?": ("at(9,3,2)", "after step 9 the agent"),
}
# What newcomers type as well; and the page that they want.
WORDS = {
    "optimal map": "first-questions",
    "bibtex": "first-questions",
    "performance": "first-questions",
    "at(T,P,S)": "index",
    "compass": "knowledge",
    "odometry": "knowledge",
    "marker": "writing-instances",
    "dstate": "index",
    "install": "index",
}


def test_each_rule_of_the_paper_is_beside_what_it_states():
    """Nothing is lost, and each sentence in quotation marks is on the page."""
    (page,) = theory.pages().values()
    quoted = 0
    for path in PAPER.glob("*.lp"):
        source = path.read_text()
        body = source[source.index("\n\n") :]
        found = [*theory.pairs(source)]
        rules = [line for _, block in found for line in block.splitlines() if line.strip()]
        lines = [line for line in body.splitlines() if line.strip()]
        assert rules == [line for line in lines if not line.startswith("%")]
        said = [line for comment, _ in found for line in comment.splitlines()]
        assert said == [line[1:].strip() for line in lines if line.startswith("%")]
        for _, block in found:
            assert f"```prolog\n{block}\n```" in page
        for comment, _ in found:
            for words in re.findall(r'"([^"]*)"', " ".join(comment.split())):
                assert f"“{words}”" in page.replace("\\", "")
                quoted += 1
    assert quoted > 12


def test_sentences_are_parted_where_rules_end():
    source = '% a.lp -- b\n\n% "one"\n% two\na. b.\nc.\n\nd.\n% three\ne.\n'
    assert [*theory.pairs(source)] == [('"one"\ntwo', "a. b.\nc.\n\nd."), ("three", "e.")]


def test_each_encoding_has_its_head_and_its_rules():
    made = encodings.pages()
    for path in (ROOT / "encodings").rglob("*.lp"):
        page, _, anchor = links.place(str(path.relative_to(ROOT))).partition("#")
        text = made[page]
        assert f"## `{path.name}` {{: #{anchor} }}" in text
        for line in path.read_text().splitlines():
            assert not line.strip() or f"    {line}" in text
        head = encodings.head_of(path.read_text())
        assert head.name == path.name
        assert head.purpose
        assert "Source" in head.sections, path


def test_each_option_of_each_command_is_told():
    told = 0
    for name in commands.names():
        page = commands.page(name)
        parser = commands.parser_of(name)
        for action in parser._actions:
            if action.help != argparse.SUPPRESS and action.dest != "help":
                for option in action.option_strings:
                    assert re.search(rf"^`[^`]*{option}\b", page, re.M), (name, option)
                    told += 1
        shown = run("topomap", name, "--help").stdout
        usage, _, _ = shown.partition("\n\n")
        assert " ".join(usage.removeprefix("usage: ").split()) in " ".join(page.split())
    assert told > 200


@pytest.mark.parametrize(
    ("link", "origin", "page", "moved"),
    [
        ("../README.md#words", "docs/files.md", "files.md", "index.md#words"),
        ("docs/files.md", "README.md", "index.md", "files.md"),
        ("../docs/phases.md", "encodings/README.md", "reference/glossary.md", "../phases.md"),
        ("../tests/a.py", "docs/files.md", "files.md", "source/tests/a.py.md"),
        (
            "../encodings/query.lp",
            "docs/questions.md",
            "questions.md",
            "reference/encodings/parts.md#query.lp",
        ),
        ("https://example.org/a.md", "docs/files.md", "files.md", "https://example.org/a.md"),
        ("#words", "README.md", "index.md", "#words"),
    ],
)
def test_links_lead_to_pages_of_the_site(link, origin, page, moved):
    text = f"[`{link}`]({link}) and `[a]({link})`\n```text\n[a]({link})\n```\n"
    wanted = f"[`{link}`]({moved}) and `[a]({link})`\n```text\n[a]({link})\n```\n"
    assert links.for_site(text, origin, page) == wanted


# The built site.


def building():
    """The arguments of mkdocs, as ``make docs`` has them."""
    recipe = (ROOT / "Makefile").read_text()
    (arguments,) = re.findall(r"^\t.*\$\(BIN\)/mkdocs (.*)$", recipe, re.M)
    return arguments.split()


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[to a heading](other.md#here)", None),
        ("[to no heading](other.md#there)", "does not contain an anchor '#there'"),
        ("[to no page](nowhere.md)", "the target is not found"),
        ("![no picture](nothing.svg)", "the target is not found"),
    ],
)
def test_a_link_that_leads_nowhere_ends_the_build(tmp_path, text, fault):
    """By the settings of mkdocs.yml, for a site of two pages."""
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/index.md").write_text(f"# A\n\n{text}\n")
    (tmp_path / "docs/other.md").write_text("# B\n\n## Here\n")
    settings = f"INHERIT: {ROOT}/mkdocs.yml\nhooks: []\nwatch: []\nextra_css: []\n"
    pages = "nav: [index.md, other.md]\nplugins: []\nsite_dir: site\n"
    (tmp_path / "mkdocs.yml").write_text(settings + pages)
    done = subprocess.run(
        [BIN / "mkdocs", *building()], capture_output=True, text=True, cwd=tmp_path
    )
    assert bool(done.returncode) == bool(fault), done.stderr
    assert (fault or "") in done.stderr


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [BIN / "mkdocs", *building(), "--site-dir", folder],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    return folder


class Page(HTMLParser):
    """The links, the anchors and the text of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors, self.text = [], set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        told = dict(attributes)
        self.links += [told[name] for name in ("href", "src") if told.get(name)]
        self.anchors |= {told[name] for name in ("id", "name") if told.get(name)}

    def handle_data(self, data):
        self.text.append(data)


@pytest.mark.long
def test_every_link_and_picture_of_the_site_is_there(site):
    """Those of HTML, too, which mkdocs does not look at; and nothing is fetched from elsewhere."""
    pages = {path: Page(path.read_text()) for path in site.rglob("*.html")}
    assert len(pages) > 60
    looked = 0
    for path, page in pages.items():
        if path.name == "404.html":  # its links are from the root of a host
            continue
        for link in page.links:
            address, anchor = urldefrag(link)
            if urlsplit(address).scheme:
                continue
            target = (path.parent / unquote(address)).resolve() if address else path
            assert target.exists(), (path.name, link)
            if anchor and target.suffix == ".html":
                assert unquote(anchor) in pages[target].anchors, (path.name, link)
            looked += 1
    assert looked > 5000
    for path in site.rglob("*.html"):
        fetched = re.findall(
            r'<(?:script|img|link)[^>]+(?:src|href)="(\w+:[^"]+)"', path.read_text()
        )
        assert not fetched, path


@pytest.mark.long
def test_the_pages_say_what_they_are_made_of(site):
    def text(name):
        return " ".join("".join(Page((site / name).read_text()).text).split())

    tutorial = text("tutorial.html")
    assert "88 consistent maps, complete: True, fault: None" in tutorial  # the notebook was run
    assert len([*(site / "tutorial").glob("*.svg")]) == 2
    python = text("reference/python.html")
    for name in topomap.__all__:
        assert name.startswith("_") or f"topomap.{name}" in python
    assert "seconds of search after which it stops" in python  # a parameter of solve
    assert "the answer is no, and that is proved" in text("reference/exit-statuses.html")


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture
def served(site, browser):
    """The address of the site, which is shown in a window that is wide."""
    browser.set_window_size(1400, 1000)
    handler = partial(Quiet, directory=site)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def waited(browser, what):
    from selenium.webdriver.support.ui import WebDriverWait

    return WebDriverWait(browser, 30).until(what)


def read(browser):
    """What a result shows: the section to which it leads, or the first one of its page."""
    text = browser.execute_script(
        """const title = document.querySelector("h2:target, h3:target");
        let text = "", one = title || document.querySelector("article").firstElementChild;
        while (one && (!text || !one.matches("h2"))) {
          text += " " + one.innerText;
          one = one.nextElementSibling;
        }
        return text;"""
    )
    return " ".join(text.split())


def searched(browser, served, typed):
    """The first four links of the results of a search."""
    browser.get(f"{served}/index.html")
    browser.execute_script("document.getElementById('__search').click()")
    field = waited(browser, lambda b: b.find_element("css selector", ".md-search__input"))
    waited(browser, lambda _: field.is_displayed() and field.is_enabled())
    field.send_keys(typed)
    waited(browser, lambda b: b.find_elements("css selector", ".md-search-result__item"))
    found = browser.find_elements("css selector", ".md-search-result__item a")
    return [one.get_attribute("href") for one in found[:4]]


@pytest.mark.long
def test_first_questions_are_answered_by_one_search(browser, served):
    """One of the first four links of the results leads to the section that has the answer."""
    asked = re.findall(r"^## (.*)$", FIRST, re.M)
    assert asked == [*QUESTIONS]
    for question, (typed, answer) in QUESTIONS.items():
        places = searched(browser, served, typed)
        texts = []
        for place in places:
            browser.get(place)
            texts.append(read(browser))
        assert any(answer in text for text in texts), (question, places)


@pytest.mark.long
def test_a_word_finds_the_page_that_explains_it(browser, served):
    """And no file of the repository comes in between."""
    for typed, page in WORDS.items():
        places = searched(browser, served, typed)
        assert urlsplit(places[0]).path == f"/{page}.html", (typed, places)
        assert not any("/source/" in place for place in places)


@pytest.mark.long
def test_the_block_of_the_first_page_is_not_one_line(browser, served):
    """Its lines, and the picture beside them, fit in the page."""
    browser.get(f"{served}/index.html")
    tall, end, page = browser.execute_script(
        """const code = [...document.querySelectorAll("td pre code")][0].getBoundingClientRect();
        const picture = document.querySelector("td img").getBoundingClientRect();
        const page = document.querySelector("article").getBoundingClientRect();
        return [code.height, picture.right, page.right];"""
    )
    assert tall > 80
    assert end <= page + 1


@pytest.mark.long
def test_first_questions_are_answered_within_two_clicks(browser, served):
    for question in QUESTIONS:
        browser.get(f"{served}/index.html")
        browser.find_element("link text", "First questions").click()
        heading = question.replace("`", "")
        waited(browser, lambda b, name=heading: b.find_elements("link text", name))
        browser.find_element("link text", heading).click()
        title = waited(browser, lambda b: b.find_element("css selector", "h2:target"))
        assert html.unescape(title.text).startswith(heading)
        top = browser.execute_script("return arguments[0].getBoundingClientRect().top", title)
        assert 0 <= top < browser.execute_script("return innerHeight")


@pytest.mark.long
def test_the_site_asks_no_other_host_and_reports_no_error(browser, served):
    browser.get_log("performance")
    browser.get_log("browser")
    for page in ("index", "theory", "gallery", "reference/python", "reference/commands/solve"):
        browser.get(f"{served}/{page}.html")
        pictures = browser.execute_script(
            "return [...document.querySelectorAll('article img')].map(i => [i.src, i.naturalWidth])"
        )
        assert all(width for _, width in pictures), page
    messages = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    asked = [
        one["params"]["request"]["url"]
        for one in messages
        if one["method"] == "Network.requestWillBeSent"
    ]
    assert len(asked) > 20
    assert not [url for url in asked if not url.startswith((served, "data:", "blob:"))]
    assert not [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
