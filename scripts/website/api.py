"""The reference of the Python functions and classes, which mkdocstrings makes of docstrings."""

import topomap
from topomap import api

HEAD = """# From Python

`import topomap` gives the functions and classes of the first part. The [tutorial](../tutorial.md)
shows them at work. The second part has the classes of what they reply, which `topomap.api` has for
annotations.
"""


def pages() -> dict[str, str]:
    """The page, by its path in the site."""
    text = f"{HEAD}\n## Functions and classes\n"
    for name in sorted(topomap.__all__, key=lambda name: (name[0].isupper(), name)):
        if not name.startswith("_"):
            text += f"\n::: topomap.{name}\n"
    text += "\n## What they reply\n"
    for name in sorted(api.__all__):
        text += f"\n::: topomap.api.{name}\n"
    return {"reference/python.md": text}
