"""How ``make docs`` makes the site: pages that are generated from the package, the encodings and
the notebook, and the links between all pages.

``hooks`` is what mkdocs calls. The other modules know nothing of mkdocs: each makes pages, as text
in Markdown. docs/DEVELOPMENT.md describes how they work together.
"""
