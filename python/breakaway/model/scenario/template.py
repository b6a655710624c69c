"""Commented files to start from, generated from the models."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

import tomli_w
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from breakaway.model.scenario.model import properties, valid_range
from breakaway.model.scenario.scenario import Scenario

WIDTH = 96
"""Longest line of a comment, in characters."""

_TAGS = ("law", "kind", "distribution")
Told = set[tuple[str, ...]]
"""Lists of laws or kinds that were explained."""
_SHOWN_BY_VALUE = ("a text", "true or false", "a table")
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
    '# F_s0, the force that breaks the joint loose at the seat, ... A number > 0 and <= 1e+09.'
    >>> "# residual_n =" in lines
    True

    """
    return template(scenario, "A scenario of breakaway.", "Run with: breakaway run FILE")


def template(model: BaseModel, what: str, use: str, named: Mapping[str, str] | None = None) -> str:
    """Write any model as TOML in which a comment explains every key.

    Parameters
    ----------
    model : BaseModel
        Gives the values.
    what, use : str
        First and last sentence of the comment on top: what the file is, and which command takes it.
    named : mapping of str to str, optional
        Keys whose tables are not written out: the name of a preset or file stands there.

    Returns
    -------
    str
        TOML.

    Examples
    --------
    >>> import breakaway as bk
    >>> method = bk.load_method("steady_feed")
    >>> template(method, "A method.", "").splitlines()[-1]
    '[knows]'

    """
    intro = (
        f"{what} Units are in the names of the keys. A key that is a comment is "
        f"left out: remove its # and give a value to set it. {use}"
    )
    shown = named or {}
    lines = [*_comment(intro), "", *_keys(model, shown), *_tables(model, "", shown, set())]
    return "\n".join(lines) + "\n"


def _keys(model: BaseModel, named: Mapping[str, str]) -> list[str]:
    """Write the model's own keys, its tag first."""
    fields = type(model).model_fields
    order = sorted(fields, key=lambda name: name not in _TAGS)
    lines: list[str] = []
    for name in order:
        value = named.get(name, getattr(model, name))
        if _is_table(value):
            continue
        if name not in _TAGS:  # the table's comment explains the tag
            lines += _comment(_explained(type(model), name, fields[name]))
        lines.append(f"# {name} =" if value is None else f"{name} = {_toml(value)}")
    return lines


def _is_table(value: object) -> bool:
    listed = isinstance(value, list) and bool(value) and isinstance(value[0], BaseModel)
    return listed or isinstance(value, BaseModel | Mapping)


def _tables(model: BaseModel, path: str, named: Mapping[str, str], told: Told) -> list[str]:
    """Write the tables within a model."""
    lines: list[str] = []
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if name in named or not _is_table(value):
            continue
        inner = f"{path}{name}"
        lines += ["", *_comment(_sentence(field.description)), *_choices(value, field, told)]
        if isinstance(value, BaseModel):
            lines += [f"[{inner}]", *_keys(value, {}), *_tables(value, f"{inner}.", {}, told)]
        elif isinstance(value, Mapping):
            lines += [f"[{inner}]", *_entries(value)]
        else:
            lines += _listed(value, inner)
    return lines


def _entries(table: Mapping[str, Any]) -> list[str]:
    """Write what stands under names of the user's own, one line each."""
    return [f"{_key(name)} = {_inline(value)}" for name, value in table.items()]


def _listed(models: Sequence[BaseModel], path: str) -> list[str]:
    """Write an array of tables; the first explains the keys of all."""
    lines: list[str] = []
    for model in models:
        if lines:
            set_keys = model.model_dump(exclude_none=True)
            lines += ["", f"[[{path}]]", *_entries(set_keys)]
        else:
            lines += [f"[[{path}]]", *_keys(model, {}), *_tables(model, f"{path}.", {}, set())]
    return lines


def _explained(owner: type[BaseModel], name: str, field: FieldInfo) -> str:
    allowed = _choice_of_items(owner, name) or valid_range(owner, name)
    if allowed.startswith(_SHOWN_BY_VALUE):
        return _sentence(field.description)
    unbroken = allowed.replace(" ", _NO_BREAK)
    return f"{_sentence(field.description)} {_sentence(unbroken[:1].upper() + unbroken[1:])}"


def _choice_of_items(owner: type[BaseModel], name: str) -> str:
    """Say what a list of words may hold."""
    schema = properties(owner)[name]
    options = [option.get("items", {}) for option in schema.get("anyOf", [schema])]
    words = next((items["enum"] for items in options if "enum" in items), None)
    if words is None:
        return "" if all(items.get("type") != "string" for items in options) else _SHOWN_BY_VALUE[0]
    return "Any of " + ", ".join(map(repr, words))


def _choices(value: Any, field: FieldInfo, told: Told) -> list[str]:  # noqa: ANN401 - a table
    """Say which laws or kinds a table can be, with their keys; each field's list stands once."""
    models = [*dict.fromkeys(_models_in(field.annotation))]
    tag = next((name for name in _TAGS if models and name in models[0].model_fields), None)
    if tag is None or len(models) < 2:
        return []
    chosen = type(value) if isinstance(value, BaseModel) else None
    lines = []
    if chosen is not None:
        lines = _comment(f'{tag} "{getattr(value, tag)}": {_summary(chosen)}')
    names = [str(model.model_fields[tag].default) for model in models]
    if tuple(names) in told:
        return lines
    told.add(tuple(names))
    for model, other in zip(models, names, strict=True):
        if model is chosen:
            continue
        keys = ", ".join(name for name in model.model_fields if name != tag)
        takes = f" Keys: {keys}." if keys else " No keys."
        lines += _comment(f'{"or " if lines else ""}{tag} "{other}": {_summary(model)}{takes}')
    return lines


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:  # noqa: ANN401 - any annotation
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


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
    if isinstance(value, list) and len(_inline(value)) <= WIDTH:
        return _inline(value)
    return tomli_w.dumps({"key": value}).removeprefix("key = ").rstrip("\n")


def _key(name: str) -> str:
    return tomli_w.dumps({name: 0}).removesuffix(" = 0\n")


def _inline(value: Any) -> str:  # noqa: ANN401 - any value of a table
    """Write a value on one line, tables and lists too."""
    if isinstance(value, BaseModel):
        return _inline(value.model_dump(exclude_none=True))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_entries(value)) + " }" if value else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_inline, value))}]"
    return _toml(value)


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
