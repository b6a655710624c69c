"""Entry point of the ``breakaway`` command."""

from __future__ import annotations

import sys

from breakaway.cli.interrupts import note_interrupts
from breakaway.cli.streams import prepare_streams


def main() -> None:
    """Run the command line and exit with its code.

    A request to terminate ends it as Ctrl-C does, so that nothing is left half written.
    """
    prepare_streams()
    try:
        note_interrupts()
        from breakaway.cli.app import app

        app()
    except KeyboardInterrupt:  # before the app could take it
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
