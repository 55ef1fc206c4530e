"""How ``make docs`` makes the site.

Pages are generated from the package, the encodings and the notebook, and all pages are linked.

``hooks`` is what mkdocs calls. The other modules know nothing of mkdocs: each makes pages, as text
in Markdown. docs/DEVELOPMENT.md describes how they work together.
"""
