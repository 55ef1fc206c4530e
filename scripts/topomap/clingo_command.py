"""The subcommand ``clingo``, as the wheel of clingo from PyPI has no such command: clingo's own
main function, options and exit statuses (10 satisfiable, 20 unsatisfiable, 30 all found, 65 bad
input)."""

from collections.abc import Sequence

from clingo.application import Application, clingo_main


class Clingo(Application):
    program_name = "clingo"


def run(arguments: Sequence[str]) -> int:
    """Run clingo with these arguments; returns its exit status."""
    return clingo_main(Clingo(), arguments)
