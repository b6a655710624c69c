"""Entry point of the ``breakaway`` command."""

from __future__ import annotations

import os
import sys

from breakaway.cli.interrupts import note_interrupts


def main() -> None:
    """Run the command line and exit with its code.

    A request to terminate ends it as Ctrl-C does, so that nothing is left half written.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the caller
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115, PTH123
    try:
        note_interrupts()
        from breakaway.cli.app import app

        app()
    except KeyboardInterrupt:  # before the app could take it
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
