"""Fill the templates of this package."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

import jinja2

from breakaway.base.text import c_comment, markdown, xml


def fill(template: str, **context: Any) -> str:  # noqa: ANN401 - whatever the template wants
    """Fill a template. A text escapes by its filter, none by itself; a missing name is an error."""
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_source),
        autoescape=False,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"comment": c_comment, "markdown": markdown, "xml": xml}
    return environment.get_template(template).render(**context)


def _source(name: str) -> str:
    return (files("breakaway.export") / "templates" / name).read_text(encoding="utf-8")
