"""The command ``clingo``, which the wheel from PyPI lacks: clingo's own main function,
options and exit statuses (10 satisfiable, 20 unsatisfiable, 30 all found, 65 bad input)."""

import sys

from clingo.application import Application, clingo_main


class Clingo(Application):
    program_name = "clingo"


def main() -> None:
    sys.exit(clingo_main(Clingo(), sys.argv[1:]))
