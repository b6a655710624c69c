"""Entry point of the ``breakaway`` command."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line and exit with its code."""
    try:
        from breakaway.cli.app import app

        app()
    except KeyboardInterrupt:  # before the app could take it
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
