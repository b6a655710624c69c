"""The report of an advice, for the person who decides: a page, and the same as PDF.

The PDF is set by typst: one package without system libraries, and reproducible. WeasyPrint, which
would print the page itself, needs Pango of the system, which many machines lack.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any

from breakaway.base.text import visible_lines
from breakaway.drawing.style import save_figure
from breakaway.errors import OutputError
from breakaway.show.report.page import inline_svg, render

Figures = Mapping[str, Any]
"""Name of a figure -> the figure."""


def advice_page(content: Mapping[str, Any], figures: Figures) -> str:
    """Write the page, as self-contained HTML.

    Parameters
    ----------
    content : mapping
        Texts and rows of the report, plain values alone.
    figures : mapping
        Its figures by name.

    """
    with tempfile.TemporaryDirectory() as folder:
        drawings = {name: inline_svg(path) for name, path in _drawn(figures, Path(folder)).items()}
    return render("advice.html.j2", **content, drawings=drawings)


def advice_pdf(content: Mapping[str, Any], figures: Figures) -> bytes:
    """Write the same as PDF; the same content gives the same bytes.

    Parameters
    ----------
    content : mapping
        Texts and rows of the report, plain values alone.
    figures : mapping
        Its figures by name.

    Raises
    ------
    OutputError
        typst is not installed.

    """
    try:
        typst: Any = import_module("typst")
    except ImportError:
        raise OutputError(
            "a PDF needs typst; install it with: pip install 'breakaway[pdf]'"
        ) from None
    with tempfile.TemporaryDirectory() as folder:
        _drawn(figures, Path(folder))
        template = (files("breakaway.show.report") / "advice.typ").read_text(encoding="utf-8")
        source = Path(folder) / "advice.typ"
        source.write_text(template, encoding="utf-8")
        text = json.dumps(_visible(content), allow_nan=False)
        pdf: bytes = typst.compile(
            source, root=folder, ignore_system_fonts=True, timestamp=0, sys_inputs={"content": text}
        )
    return pdf


def _drawn(figures: Figures, folder: Path) -> dict[str, Path]:
    paths = {name: folder / f"{name}.svg" for name in figures}
    for name, path in paths.items():
        save_figure(figures[name], path)
    return paths


def _visible(value: Any) -> Any:  # noqa: ANN401 - plain values, however they are nested
    """Show characters of texts that a page has none for."""
    if isinstance(value, str):
        return visible_lines(value)
    if isinstance(value, Mapping):
        return {key: _visible(one) for key, one in value.items()}
    return [_visible(one) for one in value] if isinstance(value, list | tuple) else value
