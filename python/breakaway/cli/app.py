"""The commands, and what becomes of their errors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from breakaway.cli.advise import advise
from breakaway.cli.compare import compare
from breakaway.cli.design import design
from breakaway.cli.events import events
from breakaway.cli.export import EXPORT, export
from breakaway.cli.help import add_command, unwrapped
from breakaway.cli.identify import identify
from breakaway.cli.logs import logs
from breakaway.cli.presets import presets
from breakaway.cli.reproduce import reproduce
from breakaway.cli.rig_from_blank import rig_from_blank
from breakaway.cli.run import run
from breakaway.cli.show import say, say_aside
from breakaway.cli.starting import init, schema
from breakaway.cli.streams import ClosedOutput
from breakaway.cli.study import study
from breakaway.cli.tune import tune
from breakaway.errors import BreakawayError

INTERRUPTED = 130

HELP = "Free seized parts: identify a joint, design a controller, simulate the extraction."

EPILOG = "\n\n".join(
    [
        unwrapped(
            "Start here",
            [
                "breakaway presets",
                "breakaway run paper_as_computed --out result",
                "breakaway init my_joint.toml",
            ],
        ),
        unwrapped(
            "Exit codes",
            [
                "0    done; a run that diverges is no error",
                "1    unexpected: a fault of breakaway",
                "2    invalid input: command line, file or log",
                "3    output cannot be written",
                "4    not stable, and --require-stable was given",
                "130  interrupted",
            ],
        ),
    ]
)


class Commands(TyperGroup):
    """Commands whose errors end in a message and an exit code."""

    # typer keeps the types of its click private
    def make_context(self, *args: Any, **options: Any) -> Any:  # noqa: ANN401
        """Read the command line; --help and --version are shown on the way."""
        with _told_ends():
            return super().make_context(*args, **options)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        """Run the command that was asked for."""
        with _told_ends():
            return super().invoke(ctx)


@contextmanager
def _told_ends() -> Iterator[None]:
    try:
        yield
    except BreakawayError as error:
        say_aside(f"error: {error}")
        raise typer.Exit(error.exit_code) from None
    except ClosedOutput as error:
        raise typer.Exit(error.exit_code) from None
    except KeyboardInterrupt:
        say_aside("interrupted")
        raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    name="breakaway",
    cls=Commands,
    help=HELP,
    epilog=EPILOG,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(asked: bool) -> None:
    if asked:
        from breakaway import __version__

        say(f"breakaway {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", "-V", callback=_print_version, is_eager=True, help="Show the version."
        ),
    ] = False,
) -> None:
    pass


add_command(
    app,
    run,
    "breakaway run paper_as_computed",
    "breakaway run my_joint.toml --out result --seed 7",
    "breakaway run result/scenario.toml  # again, bit for bit",
    "breakaway run paper_as_computed --joint joint.toml",
    "breakaway run my_joint.toml --json | jq .outcome",
)
add_command(
    app,
    study,
    "breakaway study spread.toml --out result",
    "breakaway study spread.toml --out result --resume",
    "breakaway study spread.toml --out result --json",
)
add_command(
    app,
    tune,
    "breakaway tune gentle.toml --out tuned",
    "breakaway tune gentle.toml --out tuned --resume",
    "breakaway tune gentle.toml --out tuned --json",
)
add_command(
    app,
    compare,
    "breakaway compare --runs 200 --out gallery",
    "breakaway compare my_parts.toml --method mine.toml",
    "breakaway compare --laws lugre,coulomb_stiction --out laws",
    "breakaway compare gallery/comparison.toml --out again",
)
add_command(
    app,
    advise,
    "breakaway advise joint.toml --rig screw_jack --out advice",
    "breakaway advise parts.toml --rig my_rig.toml --limits limits.toml",
    "breakaway advise seized_parts --budget-s 20 --json | jq .sentences",
)
add_command(
    app,
    design,
    "breakaway design paper_as_computed",
    "breakaway design my_joint.toml --require-stable && echo stable",
)
add_command(
    app,
    logs,
    "breakaway logs motor.tdms",
    "breakaway logs motor.csv --write-mapping motor.toml",
    "breakaway logs motor.csv --plot motor.png",
    "breakaway logs motor.mf4 --json | jq .channels",
)
add_command(
    app,
    identify,
    "breakaway identify motor.csv --out joint.toml",
    "breakaway identify motor.tdms --law lugre --report",
    "breakaway identify a.mf4 --law compare --held-out 30:60",
    "breakaway identify fast.csv --lowpass-hz 400",
)
add_command(
    app,
    events,
    "breakaway events part_1.csv part_2.csv --population",
    "breakaway events seal.csv --use force_n=friction_n --json",
)
add_command(
    app,
    rig_from_blank,
    "breakaway rig-from-blank held.csv --out rig.toml",
    "breakaway rig-from-blank held.csv without_part.csv --out rig.toml",
    "breakaway identify pull.csv --law lugre --rig rig.toml",
)
add_command(app, presets, "breakaway presets", "breakaway presets --json")
add_command(
    app,
    init,
    "breakaway init my_joint.toml",
    "breakaway init my_joint.toml --preset paper_as_printed",
    "breakaway init my_method.toml --kind method",
    "breakaway init sweep.toml --kind sweep --preset my_joint.toml",
)
add_command(
    app,
    schema,
    "breakaway schema --out scenario.schema.json",
    "breakaway schema --kind study",
)
add_command(
    app,
    reproduce,
    "breakaway reproduce",
    "breakaway reproduce --out paper",
    "breakaway reproduce --full --out paper  # minutes",
)
app.add_typer(export, name="export", short_help=EXPORT)
