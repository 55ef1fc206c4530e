"""Entry point of the command: an interrupt while Python still loads ends it cleanly too."""

import sys


def run() -> None:
    try:
        from topomap.cli import main

        sys.exit(main())
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    run()
