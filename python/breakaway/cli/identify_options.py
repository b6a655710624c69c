"""The options of ``breakaway identify``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class LogFormat(StrEnum):
    """The formats of `breakaway.measure.logs`; here, so that the command starts without them."""

    CSV = "csv"
    PARQUET = "parquet"
    MAT = "mat"
    HDF5 = "hdf5"
    TDMS = "tdms"
    MDF = "mdf"
    MCAP = "mcap"
    EMPS = "emps"


class LawChoice(StrEnum):
    """Laws of `breakaway.measure.identification.LAWS`, and all of them, compared."""

    COULOMB = "coulomb"
    STRIBECK = "stribeck"
    LUGRE = "lugre"
    ELASTO_PLASTIC = "elasto_plastic"
    COMPARE = "compare"


class MotionChoice(StrEnum):
    """Motions of `breakaway.identify`."""

    IMPOSED = "imposed"
    FREE = "free"
    CLOSED_LOOP = "closed_loop"


class LossChoice(StrEnum):
    """Losses of `breakaway.identify`."""

    LINEAR = "linear"
    SOFT_L1 = "soft_l1"
    HUBER = "huber"
    CAUCHY = "cauchy"


Law = Annotated[
    LawChoice | None,
    typer.Option(
        help="Friction law to fit by simulation; compare fits all of them and says which pay. "
        "Left out: mass, Coulomb and viscous friction by regression."
    ),
]
Motion = Annotated[
    MotionChoice,
    typer.Option(
        help="What is predicted: with imposed the force, with free the position, with closed_loop "
        "the force."
    ),
]
Asymmetric = Annotated[
    bool, typer.Option("--asymmetric", help="Separate friction levels for each direction.")
]
PositionDependent = Annotated[
    bool, typer.Option("--position-dependent", help="Friction that changes with position.")
]
Controller = Annotated[
    Path | None,
    typer.Option(help="TOML file of the rig's controller, for closed_loop.", metavar="FILE"),
]
Repeat = Annotated[
    list[str] | None,
    typer.Option(help="Span to fit, in s; once for each repeat.", metavar="START:END"),
]
HeldOut = Annotated[
    str | None,
    typer.Option(help="Span to predict and not to fit, in s.", metavar="START:END"),
]
Fix = Annotated[
    list[str] | None,
    typer.Option(help="Hold a parameter at a value; repeatable.", metavar="NAME=VALUE"),
]
Free = Annotated[
    list[str] | None,
    typer.Option(
        help="Fit a parameter although the log hardly excites it; repeatable.", metavar="NAME"
    ),
]
Loss = Annotated[LossChoice, typer.Option(help="Loss; all but linear are robust to outliers.")]
Starts = Annotated[int, typer.Option(min=1, help="How many starting points to follow.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the starting points and of draws.")]
Posterior = Annotated[
    int,
    typer.Option(min=0, help="Draws from the posterior (needs the extra posterior).", metavar="N"),
]
Format = Annotated[
    LogFormat | None, typer.Option(help="Format of the log.", show_default="guessed")
]
Out = Annotated[
    Path | None,
    typer.Option(help="Joint file to write, for run --joint and for studies.", metavar="FILE"),
]
Report = Annotated[
    bool,
    typer.Option(
        "--report",
        help="Also write an HTML report: beside --out, or in this folder under the log's name.",
    ),
]
LowpassHz = Annotated[float | None, typer.Option(help="Cutoff of the low-pass on position.")]
Decimation = Annotated[
    int | None,
    typer.Option(help="Samples of the log for each one of the regression.", show_default="10"),
]
