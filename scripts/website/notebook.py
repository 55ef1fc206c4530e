"""The tutorial: the notebook, run, as a page."""

import os
import tempfile
from pathlib import Path
from subprocess import DEVNULL

import nbformat
from nbclient import NotebookClient
from nbconvert import MarkdownExporter

from website.links import ROOT

BOOK = ROOT / "docs/tutorial.ipynb"
SECONDS = 600  # for one cell, on a machine that is busy


def page() -> tuple[str, dict[str, bytes]]:
    """The page as Markdown, and its pictures by their paths in the site."""
    book = nbformat.read(BOOK, as_version=4)  # type: ignore[no-untyped-call]
    with tempfile.TemporaryDirectory() as history:  # IPython would write one at home
        before = os.environ.get("IPYTHONDIR")
        os.environ["IPYTHONDIR"] = history
        try:
            resources = {"metadata": {"path": BOOK.parent}}
            NotebookClient(book, timeout=SECONDS, resources=resources).execute(stderr=DEVNULL)
        finally:
            os.environ.pop("IPYTHONDIR")
            if before is not None:
                os.environ["IPYTHONDIR"] = before
    exporter = MarkdownExporter()  # type: ignore[no-untyped-call]
    text, made = exporter.from_notebook_node(
        book, {"unique_key": "tutorial-", "output_files_dir": "tutorial"}
    )
    pictures = {str(Path(name).as_posix()): data for name, data in made["outputs"].items()}
    note = "This page is the notebook `docs/tutorial.ipynb`, run when the site was made.\n"
    head, _, rest = text.partition("\n\n")
    return f"{head}\n\n{note}\n{rest}", pictures
