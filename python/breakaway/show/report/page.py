"""Render a self-contained HTML page."""

from __future__ import annotations

import re
import tempfile
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup
from matplotlib.figure import Figure

from breakaway.base.text import visible_lines
from breakaway.drawing.style import save_figure


def render(template: str, **context: Any) -> str:  # noqa: ANN401 - whatever the template wants
    """Fill a template of this package.

    Text is escaped, and what HTML has no character for is shown; a missing name is an error.
    """
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_source),
        autoescape=True,
        finalize=_finalized,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["inline_svg"] = inline_svg
    environment.filters["decimal"] = decimal_number
    environment.filters["digits"] = significant
    return environment.get_template(template).render(**context)


def _source(name: str) -> str:
    return (files("breakaway.show.report") / name).read_text(encoding="utf-8")


def _finalized(value: object) -> object:
    if isinstance(value, Markup) or not isinstance(value, str):
        return value
    return visible_lines(value)


def inline_svg(path: Path) -> Markup:
    """The SVG file of a drawing for the inside of a page: no XML header, as wide as the page.

    Its names get the file's name as a prefix: those of two drawings on a page must not meet.
    """
    svg = path.read_text(encoding="utf-8")
    svg = re.sub(r'( id="|url\(#|href="#)', rf"\1{path.stem}-", svg[svg.index("<svg") :])
    opening, rest = svg.split(">", 1)
    opening = re.sub(r' (width|height)="[^"]*"', "", opening)
    return Markup(f"{opening}>{rest}")


def drawn_svg(figure: Figure, key: str) -> Markup:
    """Give a drawing for the inside of a page, without the metadata that name their makers."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{key}.svg"
        save_figure(figure, path)
        bare = re.sub(r"<metadata>.*?</metadata>", "", path.read_text(encoding="utf-8"), flags=re.S)
        path.write_text(bare, encoding="utf-8")
        return inline_svg(path)


def decimal_number(value: float, places: int) -> str:
    """A number with a given number of decimal places."""
    return f"{value:,.{places}f}"


def significant(value: float | None, factor: float = 1.0) -> str:
    """A number times a factor, with three significant digits; a dash where there is none."""
    return "–" if value is None else f"{value * factor:.3g}"
