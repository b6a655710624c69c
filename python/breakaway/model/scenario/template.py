"""A commented scenario file, generated from the models."""

from __future__ import annotations

import textwrap
from types import NoneType
from typing import Any, get_args

import tomli_w
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from breakaway.model.scenario.model import valid_range
from breakaway.model.scenario.scenario import Scenario

WIDTH = 96
"""Longest line of a comment, in characters."""

_TAGS = ("law", "kind")
_NO_BREAK = "\N{NO-BREAK SPACE}"


def scenario_template(scenario: Scenario) -> str:
    """Write a scenario as TOML in which a comment explains every key.

    Keys that are left out stand as comments, and every table with a law or kind names the others.
    The text loads back to the same scenario.

    Parameters
    ----------
    scenario : Scenario
        Gives the values.

    Returns
    -------
    str
        TOML.

    Examples
    --------
    >>> import breakaway as bk
    >>> text = scenario_template(bk.load_scenario("paper_as_computed"))
    >>> lines = text.splitlines()
    >>> at = lines.index("stiction_n = 450.0")
    >>> lines[at - 1]
    '# F_s0, the force that breaks the joint loose at the seat, in N. A number > 0.'
    >>> "# residual_n =" in lines
    True

    """
    intro = (
        "A scenario of breakaway. Units are in the names of the keys. A key that is a comment is "
        "left out: remove its # and give a value to set it. Run with: breakaway run FILE"
    )
    return "\n".join([*_comment(intro), "", *_keys(scenario), *_tables(scenario, "")]) + "\n"


def _keys(model: BaseModel) -> list[str]:
    """Write the model's own keys, its tag first."""
    fields = type(model).model_fields
    order = sorted(fields, key=lambda name: name not in _TAGS)
    lines: list[str] = []
    for name in order:
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            continue
        if name not in _TAGS:  # the table's comment explains the tag
            lines += _comment(_explained(type(model), name, fields[name]))
        lines.append(f"# {name} =" if value is None else f"{name} = {_toml(value)}")
    return lines


def _tables(model: BaseModel, path: str) -> list[str]:
    lines: list[str] = []
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if not isinstance(value, BaseModel):
            continue
        inner = f"{path}{name}"
        lines += ["", *_comment(_sentence(field.description)), *_choices(value, field)]
        lines += [f"[{inner}]", *_keys(value), *_tables(value, f"{inner}.")]
    return lines


def _explained(owner: type[BaseModel], name: str, field: FieldInfo) -> str:
    allowed = valid_range(owner, name)
    if allowed.startswith(("a text", "true or false")):  # the value shows it
        return _sentence(field.description)
    unbroken = allowed.replace(" ", _NO_BREAK)
    return f"{_sentence(field.description)} {_sentence(unbroken[:1].upper() + unbroken[1:])}"


def _choices(chosen: BaseModel, field: FieldInfo) -> list[str]:
    """Say what the chosen law or kind is, and which others there are, with their keys."""
    models = [
        model
        for model in get_args(field.annotation)
        if isinstance(model, type) and model is not NoneType and issubclass(model, BaseModel)
    ]
    tag = next((name for name in _TAGS if name in type(chosen).model_fields), None)
    if tag is None or len(models) < 2:
        return []
    lines = _comment(f'{tag} "{getattr(chosen, tag)}": {_summary(type(chosen))}')
    for model in models:
        if model is type(chosen):
            continue
        other = model.model_fields[tag].default
        keys = ", ".join(name for name in model.model_fields if name != tag)
        takes = f" Keys: {keys}." if keys else " No keys."
        lines += _comment(f'or {tag} "{other}": {_summary(model)}{takes}')
    return lines


def _summary(model: type[BaseModel]) -> str:
    """Give the first paragraph of a model's docstring."""
    text = (model.__doc__ or "").strip().split("\n\n")[0]
    return _sentence(text.replace("``", ""))


def _sentence(text: str | None) -> str:
    words = " ".join((text or "").split())
    return f"{words.rstrip('.')}." if words else ""


def _comment(text: str) -> list[str]:
    lines = textwrap.wrap(text, WIDTH - 2, break_long_words=False, break_on_hyphens=False)
    return [f"# {line}".replace(_NO_BREAK, " ") for line in lines]


def _toml(value: Any) -> str:  # noqa: ANN401 - any plain value
    if isinstance(value, float):
        return _number(value)
    return tomli_w.dumps({"key": value}).removeprefix("key = ").rstrip("\n")


def _number(value: float) -> str:
    """Write a number as shortly as reads back bit for bit; large ones as 3.6e7."""
    plain = repr(value)
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return plain
    for digits in range(17):
        mantissa, exponent = f"{value:.{digits}e}".split("e")
        text = f"{mantissa}e{int(exponent)}"
        if float(text) == value:
            return text
    return plain
