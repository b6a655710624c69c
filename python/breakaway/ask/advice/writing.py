"""The folder of an advice: report on a page and on paper, figures, the method, all numbers."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path

import tomli_w

from breakaway.ask.advice.content import content_of, figures_of
from breakaway.ask.advice.measurement import Measurement
from breakaway.ask.advice.result import Advice
from breakaway.base.arguments import check_arguments
from breakaway.base.output import output_folder
from breakaway.base.ownership import ADVICE
from breakaway.drawing.style import save_figure
from breakaway.errors import StudyError
from breakaway.show.report.advice import advice_page, advice_pdf

FILES = ("index.html", "report.pdf", "advice.json", "method.toml")


def write_advice(
    advice: Advice, folder: str | Path, *, command: str = "", made_of: tuple[str, ...] = ()
) -> list[Path]:
    """Write the report as page and PDF, its figures, the recommended method and all numbers.

    Without typst, the extra ``pdf``, there is no PDF.

    Parameters
    ----------
    advice : Advice
        What is written.
    folder : str or Path
        Where; made if it is missing.
    command : str
        How to repeat it, as the report shows.
    made_of : tuple of str
        Files that were read, with their digests, as the report shows.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OutputError
        The folder cannot be written, or holds a result of another kind or files of others.

    """
    check_arguments(write_advice, locals(), StudyError)
    folder = Path(folder)
    content, figures = content_of(advice, command, made_of), figures_of(advice)
    with output_folder(folder, ADVICE, FILES) as staging:
        (staging / "index.html").write_text(advice_page(content, figures), encoding="utf-8")
        if find_spec("typst") is not None:
            (staging / "report.pdf").write_bytes(advice_pdf(content, figures))
        text = json.dumps(advice.to_dict(), indent=1, allow_nan=False) + "\n"
        (staging / "advice.json").write_text(text, encoding="utf-8")
        method = tomli_w.dumps(advice.method.model_dump(mode="json", exclude_none=True))
        (staging / "method.toml").write_text(method, encoding="utf-8")
        if advice.measurement is not None:
            (staging / "reference.csv").write_text(_reference(advice.measurement))
        for name, figure in figures.items():
            save_figure(figure, staging / f"{name}.png")
        names = sorted(path.name for path in staging.iterdir())
    return [folder / name for name in names]


def _reference(measurement: Measurement) -> str:
    """Give the reference as the rig takes it."""
    rows = zip(measurement.t_s, measurement.force_n, strict=True)
    return "t_s,force_N\n" + "".join(f"{t:.3f},{force:.6g}\n" for t, force in rows)
