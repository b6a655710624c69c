"""Render a self-contained HTML page."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup


def render(template: str, **context: Any) -> str:  # noqa: ANN401 - whatever the template wants
    """Fill a template of this package. Text is escaped; a missing name is an error."""
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_source),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["inline_svg"] = inline_svg
    environment.filters["number"] = readable_number
    return environment.get_template(template).render(**context)


def _source(name: str) -> str:
    return (files("breakaway.report") / name).read_text(encoding="utf-8")


def inline_svg(path: Path) -> Markup:
    """The SVG file of a drawing for the inside of a page: no XML header, as wide as the page.

    Its names get the file's name as a prefix: those of two drawings on a page must not meet.
    """
    svg = path.read_text(encoding="utf-8")
    svg = re.sub(r'( id="|url\(#|href="#)', rf"\1{path.stem}-", svg[svg.index("<svg") :])
    opening, rest = svg.split(">", 1)
    opening = re.sub(r' (width|height)="[^"]*"', "", opening)
    return Markup(f"{opening}>{rest}")


def readable_number(value: float | str | None) -> str:
    """A number with six digits, or the text as it is; a dash for what does not exist."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    return f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:.6g}"
