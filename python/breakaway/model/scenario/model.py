"""What all parts of a scenario have in common, and how their errors read."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Self, get_origin

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticCustomError

from breakaway.base.text import LONGEST_NAME, brief, shown, visible
from breakaway.errors import ScenarioError

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(ge=0.0, le=1.0)]


def _one_line(name: str) -> str:
    if visible(name) != name:
        raise PydanticCustomError("hidden_characters", "has hidden characters")
    return name


Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME), AfterValidator(_one_line)]
"""A short text that everyone can read: no line breaks, control characters or turns of direction."""
Text = Annotated[str, Field(max_length=10_000)]
"""A longer text, of any characters."""


class Model(BaseModel):
    """A part of a scenario: immutable, no unknown keys, no conversions, finite numbers only."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        hide_input_in_errors=True,
    )

    if not TYPE_CHECKING:  # type checkers see the signature that pydantic makes

        def __init__(self, **values: Any) -> None:  # noqa: ANN401 - pydantic checks them
            """Check the values; a `ScenarioError` names every field that is not valid."""
            try:
                super().__init__(**values)
            except ValidationError as error:
                raise ScenarioError(explain(error, type(self))) from None

        # Lets pydantic validate nested models by itself, so that errors keep their whole path.
        __init__.__pydantic_base_init__ = True

    @classmethod
    def parse(cls, values: Mapping[str, Any]) -> Self:
        """Build from nested plain values, as read from a TOML file."""
        return cls(**values)


def numbers_of(model: BaseModel, prefix: str = "") -> Iterator[str]:
    """Give the dotted paths of all fields of a model that hold a number."""
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            yield from numbers_of(value, f"{prefix}{name}.")
        elif holds_number(field.annotation):
            yield f"{prefix}{name}"


def holds_number(annotation: object) -> bool:
    """Whether a field holds a number, maybe one within bounds or one that may be left out."""
    if get_origin(annotation) in (tuple, dict, list):  # many numbers are none
        return False
    return annotation is float or any(map(holds_number, getattr(annotation, "__args__", ())))


MOST_EXPLAINED = 10
"""Most invalid fields that a message names."""


def explain(error: ValidationError, model: type[BaseModel]) -> str:
    """One line for each invalid field: its path, its value, the valid range and the remedy.

    A field that would follow another one, which is not valid, has nothing wrong of its own.
    """
    wrong = [
        detail
        for detail in error.errors()
        if detail["type"] != "default_factory_not_called" and not _is_word_of_union(detail)
    ]
    looked_at = wrong[:MOST_EXPLAINED]
    lines = [*dict.fromkeys(_line(detail, model) for detail in looked_at)]
    if len(wrong) > len(looked_at):
        lines.append(f"and {len(wrong) - len(looked_at):,} more")
    return "\n".join(lines)


def _is_word_of_union(detail: ErrorDetails) -> bool:
    """Whether this is about a word that a number may be: the number's own error tells enough."""
    return bool(detail["loc"]) and str(detail["loc"][-1]).startswith("literal[")


def _line(detail: ErrorDetails, model: type[BaseModel]) -> str:
    keys = [str(key) for key in detail["loc"]]
    path = [brief(key) for key in keys if not key.startswith("constrained-")]
    value = detail.get("input")
    context = detail.get("ctx", {})
    kind = detail["type"]
    names, owner = _descend(path, model)
    field = ".".join(names) or model.__name__.lower()
    if kind == "extra_forbidden":
        return _unknown_key(names, owner)
    if kind == "missing":
        return f"{field}: is missing; give {_wanted(owner, names[-1])}"
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return _wrong_kind(field, value, context)
    if kind == "literal_error":
        return f"{field}: {shown(value)} is not one of {context['expected']}"
    if kind == "value_error":
        reason = context["error"]
        return str(reason) if not names else f"{field}.{reason}"
    if names and names[-1].isdigit():  # a number of a list: the list's field is described
        names, owner = _descend(path[:-1], model)
    remedy = _wanted(owner, names[-1] if names else "")
    bound = next((key for key in _SIGNS if key in context), None)
    if bound is not None:
        limit = context[bound]
        return f"{field}: {shown(value)} is not {_SIGNS[bound]} {limit:g}; give {remedy}"
    if kind == "finite_number":
        return f"{field}: {shown(value)} is not finite; give {remedy}"
    known = _TYPE_NAMES.get(kind, "").format(**context)
    expected = known or detail["msg"][:1].lower() + detail["msg"][1:]
    return f"{field}: {shown(value)} is not {expected}; give {remedy}"


_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
_TYPE_NAMES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "a text",
    "string_unicode": "a text",
    "string_too_short": "a text of at least {min_length} character",
    "string_too_long": "a text of at most {max_length} characters",
    "hidden_characters": "one line without control characters",
    "model_type": "a table of keys",
    "model_attributes_type": "a table of keys",
    "dict_type": "a table of keys",
    "tuple_type": "a list of numbers",
    "too_long": "a list of at most {max_length} numbers",
}


def _descend(
    path: Sequence[str], model: type[BaseModel]
) -> tuple[list[str], type[BaseModel] | None]:
    """The path without the names of union members, and the model that its last key belongs to."""
    names: list[str] = []
    owner: type[BaseModel] | None = model
    candidates: list[type[BaseModel]] = [model]
    for key in path:
        tagged = [candidate for candidate in candidates if key in _tags(candidate)]
        if tagged and len(candidates) > 1:  # a union's tags come right after its field
            candidates = tagged
            continue
        owner = next(
            (c for c in candidates if key in c.model_fields), candidates[0] if candidates else None
        )
        names.append(key)
        annotation = (
            owner.model_fields[key].annotation if owner and key in owner.model_fields else None
        )
        candidates = _models_in(annotation)
    return names, owner


def _tags(model: type[BaseModel]) -> set[str]:
    """Names by which a union may refer to the model."""
    return {model.__name__, *(str(field.default) for _, field in _tag_fields(model))}


def _tag_fields(model: type[BaseModel] | None) -> list[tuple[str, FieldInfo]]:
    """The field that tells the members of a union apart, if the model has one."""
    fields = model.model_fields if model else {}
    return [(name, fields[name]) for name in ("law", "kind") if name in fields]


def _models_in(annotation: Any) -> list[type[BaseModel]]:  # noqa: ANN401 - any annotation
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in getattr(annotation, "__args__", ()) for model in _models_in(part)]


def _unknown_key(names: Sequence[str], owner: type[BaseModel] | None) -> str:
    known = list(owner.model_fields) if owner else []
    near = difflib.get_close_matches(names[-1], known, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]}?" if near else f"known keys: {', '.join(known)}"
    whose = [f" (the keys of {tag} '{field.default}')" for tag, field in _tag_fields(owner)]
    return f"{'.'.join(names)}: is not a known key; {hint}{''.join(whose)}"


def _wrong_kind(field: str, value: object, context: Mapping[str, Any]) -> str:
    tag = str(context.get("discriminator", "kind")).strip("'")
    expected = context.get("expected_tags")
    if expected is None:
        keys = shown(sorted(value) if isinstance(value, Mapping) else value)
        return f"{field}.{tag}: is missing; say which kind this is (the keys given are {keys})"
    given = context.get("tag")
    near = difflib.get_close_matches(str(given), expected.replace("'", "").split(", "), n=1)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return f"{field}.{tag}: {shown(given)} is not one of {expected}{hint}"


def _wanted(owner: type[BaseModel] | None, name: str) -> str:
    """The description of a field, with its valid range."""
    field = owner.model_fields.get(name) if owner else None
    if field is None:
        return "a valid value"
    described = " ".join((field.description or "").split()).rstrip(".")
    return f"{valid_range(owner, name)}: {described}".rstrip(": ")


def valid_range(owner: type[BaseModel] | None, name: str) -> str:
    """The valid range of a field in words, such as ``a number > 0``."""
    schema = properties(owner).get(name, {}) if owner else {}
    options = [o for o in schema.get("anyOf", [schema]) if o.get("type") != "null"]
    option = options[0] if options else {}
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    bounds = " and ".join(f"{sign} {option[key]:g}" for key, sign in signs.items() if key in option)
    if "enum" in option:
        return "one of " + ", ".join(repr(value) for value in option["enum"])
    word = {
        "number": "a number",
        "integer": "a whole number",
        "boolean": "true or false",
        "string": "a text",
        "array": "a list of numbers",
    }.get(option.get("type", ""), "a table")
    if "maxLength" in option:
        bounds = f"of {option.get('minLength', 0)} to {option['maxLength']} characters"
    return f"{word} {bounds}".strip()


@functools.cache
def properties(model: type[BaseModel]) -> dict[str, Any]:
    """Give the JSON schema of each field of a model."""
    found: dict[str, Any] = model.model_json_schema()["properties"]
    return found
