"""The one style of all figures: readable in print, safe for color-blind readers, deterministic."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from breakaway.model.units import unit_with

COLORS = {
    "ours": "#0072B2",
    "alternative": "#D55E00",
    "third": "#009E73",
    "fourth": "#CC79A7",
    "fifth": "#E69F00",
    "event": "#00795A",
    "alarm": "#B5300F",
    "reference": "#B0B0B0",
    "axis": "#6B6B6B",
    "text": "#1A1A1A",
}
"""What a color stands for -> the color: Okabe and Ito's, which color-blind readers tell apart."""

WIDTH_IN = 7.0
"""Width of a figure across a page, in inches."""

_STYLE: Any = {
    "axes.axisbelow": True,
    "axes.edgecolor": COLORS["axis"],
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.labelcolor": COLORS["text"],
    "axes.labelsize": 9,
    "axes.linewidth": 0.7,
    "axes.prop_cycle": cycler(
        color=[COLORS[k] for k in ("ours", "alternative", "third", "fourth", "fifth")]
    ),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "figure.constrained_layout.use": True,
    "figure.dpi": 100,
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "grid.color": "#E3E3E3",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "lines.solid_capstyle": "round",
    "savefig.dpi": 200,
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "breakaway",
    "text.color": COLORS["text"],
    "xtick.color": COLORS["axis"],
    "xtick.labelcolor": COLORS["text"],
    "xtick.labelsize": 8,
    "ytick.color": COLORS["axis"],
    "ytick.labelcolor": COLORS["text"],
    "ytick.labelsize": 8,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the project's style; the user's own style is back afterwards.

    Examples
    --------
    >>> with house_style():
    ...     Figure().get_dpi()
    100.0

    """
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


def house_figure(height: float, width: float = WIDTH_IN) -> Figure:
    """Make an empty figure in the project's style, its sizes in inches, apart from pyplot.

    What is drawn into it later takes its style from the moment of drawing: draw within
    `house_style`.

    Examples
    --------
    >>> house_figure(height=3.0).get_size_inches().tolist()
    [7.0, 3.0]

    """
    with house_style():
        return Figure(figsize=(width, height))


def save_figure(figure: Figure, path: str | Path) -> None:
    """Save a figure as PNG, SVG or PDF; the same figure gives the same bytes.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_figure(Figure(figsize=(1.0, 1.0)), Path(folder) / "empty.svg")

    """
    target = Path(path)
    dates = {".svg": "Date", ".pdf": "CreationDate"}
    key = dates.get(target.suffix)
    with house_style():
        figure.savefig(target, metadata={key: None} if key else None)


def scaled(values: ArrayLike, unit: str) -> tuple[float, str]:
    """Give the factor and the prefixed unit in which the values are easy to read.

    Parameters
    ----------
    values : array_like
        What an axis shows, in ``unit``; what is not finite is left out.
    unit : str
        Symbol of a unit of `breakaway.model.units`, such as ``N s/m``.

    Examples
    --------
    >>> scaled([0.0, 7.1e-5], "m"), scaled([601.0], "N"), scaled([12_500.0], "N")
    ((1000000.0, 'µm'), (1.0, 'N'), (0.001, 'kN'))

    """
    array: NDArray[np.float64] = np.abs(np.asarray(values, dtype=np.float64))
    finite = array[np.isfinite(array)]
    largest = float(finite.max()) if finite.size else 0.0
    power = unit_with(unit).power_of(largest * (1 + 1e-9)) if largest else 0
    return 10.0**-power if power <= 0 else 1.0 / 10.0**power, unit_with(unit).prefixed(power)
