"""The commands, and what becomes of their errors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from breakaway.cli.compare import compare
from breakaway.cli.design import design
from breakaway.cli.events import events
from breakaway.cli.export import export
from breakaway.cli.identify import identify
from breakaway.cli.presets import presets
from breakaway.cli.reproduce import reproduce
from breakaway.cli.run import run
from breakaway.cli.show import say, say_aside
from breakaway.cli.starting import init, schema
from breakaway.cli.streams import ClosedOutput
from breakaway.cli.study import study
from breakaway.cli.tune import tune
from breakaway.errors import BreakawayError

INTERRUPTED = 130

HELP = "Free seized parts: identify a joint, design a controller, simulate the extraction."

EPILOG = """
[bold]Start here[/bold]
  breakaway presets
  breakaway run paper_as_computed --out result
  breakaway init my_joint.toml

[bold]Exit codes[/bold]
  0    done; a run that diverges is a finding, not an error
  1    unexpected: a fault of breakaway
  2    invalid input: command line, scenario, study, joint file or log
  3    output can not be written
  4    not stable, where --require-stable asks for it
  130  interrupted
"""


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
    rich_markup_mode="rich",
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


def _examples(*lines: str) -> str:
    return "\n  ".join(("[bold]Examples[/bold]", *lines))


app.command(
    epilog=_examples(
        "breakaway run paper_as_computed",
        "breakaway run my_joint.toml --out result --seed 7",
        "breakaway run result/scenario.toml  # again, bit for bit",
        "breakaway run paper_as_computed --joint joint.toml",
        "breakaway run paper_as_computed --json | jq .metrics.peak_force_n",
    )
)(run)
app.command(
    epilog=_examples(
        "breakaway study spread.toml --out result",
        "breakaway study spread.toml --out result --resume",
        "breakaway study spread.toml --out result --json | jq .result",
    )
)(study)
app.command(
    epilog=_examples(
        "breakaway tune gentle.toml --out tuned",
        "breakaway tune gentle.toml --out tuned --resume --trials 200",
        "breakaway tune gentle.toml --out tuned --json | jq .result",
    )
)(tune)
app.command(
    epilog=_examples(
        "breakaway compare --runs 200 --out gallery",
        "breakaway compare my_parts.toml --method steady_feed --method mine.toml --out gallery",
        "breakaway compare --laws lugre,coulomb_stiction --runs 100 --seed 7 --out laws",
        "breakaway compare gallery/comparison.toml --out again",
    )
)(compare)
app.command(
    epilog=_examples(
        "breakaway design paper_as_computed",
        "breakaway design my_joint.toml --require-stable && echo safe to try",
    )
)(design)
app.command(
    epilog=_examples(
        "breakaway identify motor.csv --out joint.toml",
        "breakaway identify motor.tdms --law lugre --asymmetric --out joint.toml --report",
        "breakaway identify motor.mf4 --law compare --held-out 30:60",
        "breakaway identify fast.csv --lowpass-hz 400 --decimation 5 --json",
    )
)(identify)
app.command(
    epilog=_examples(
        "breakaway events part_1.csv part_2.csv part_3.csv --population",
        "breakaway events seal.csv --use force_n=friction_n --json",
    )
)(events)
app.command(epilog=_examples("breakaway presets", "breakaway presets --json"))(presets)
app.command(
    epilog=_examples(
        "breakaway init my_joint.toml",
        "breakaway init my_joint.toml --preset paper_as_printed --force",
        "breakaway init my_method.toml --kind method --preset timed_impacts",
        "breakaway init sweep.toml --kind sweep --preset my_joint.toml",
    )
)(init)
app.command(
    epilog=_examples("breakaway schema --out scenario.schema.json", "breakaway schema --kind study")
)(schema)
app.command(
    epilog=_examples(
        "breakaway reproduce",
        "breakaway reproduce --out paper",
        "breakaway reproduce --full --out paper  # figure 10 in minutes, not seconds",
    )
)(reproduce)
app.add_typer(
    export,
    name="export",
    epilog=_examples(
        "breakaway export c paper_as_computed --what controller --out rig",
        "breakaway export c my_joint.toml --what loop --real float --out firmware",
    ),
)
