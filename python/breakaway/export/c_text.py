"""Pieces of C: literals, members, functions and calls."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from breakaway.export.interface import Variable
from breakaway.export.recording import Body, Recording


@dataclass(frozen=True)
class Types:
    """What depends on the real type."""

    real: str
    suffix: str
    largest: str
    bits: str
    mantissa: int

    def literal(self, value: float) -> str:
        """A number that this type holds exactly."""
        return f"{value!r}{self.suffix}"


FLOAT = Types("float", "f", "FLT_MAX", "uint32_t", 23)
DOUBLE = Types("double", "", "DBL_MAX", "uint64_t", 52)

_STRUCTURES = {
    "parameters": ("const {prefix}_parameters *p", "&self->parameters"),
    "derived": ("const {prefix}_derived *d", "&self->derived"),
    "state": ("{prefix}_state *s", "&self->state"),
    "input": ("const {prefix}_input *in", "in"),
    "signals": ("{prefix}_signals *w", "w"),
    "output": ("{prefix}_output *out", "out"),
}
"""Structure that a routine uses -> how it takes it, and what a step hands it."""


def types_of(recording: Recording) -> Types:
    """Give what depends on the real type of a recording."""
    return FLOAT if recording.real == "float" else DOUBLE


def member(prefix: str, one: Variable) -> str:
    """Declare a member of a structure, with what it is."""
    said = one.unit == "1" or f"in {one.unit}" in one.description
    unit = "" if said else f" In {one.unit}."
    text = one.description if one.description.endswith(".") else f"{one.description}."
    return "\n".join([*_comment(f"{text}{unit}"), f"    {prefix}_real {one.name};"])


def _comment(text: str) -> Iterator[str]:
    lines = wrapped(text, 90)
    if len(lines) == 1:
        yield f"    /** {lines[0]} */"
        return
    yield f"    /** {lines[0]}"
    for line in lines[1:-1]:
        yield f"     *  {line}"
    yield f"     *  {lines[-1]} */"


def wrapped(text: str, width: int) -> list[str]:
    """Break a text into lines."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".lstrip()
    return lines


def function(prefix: str, name: str, body: Body, title: str) -> str:
    """Define the function of a routine."""
    taken = [
        _taken(prefix, structure, body, writes=name == "derive")
        for structure in _STRUCTURES
        if structure in body.uses
    ]
    return f"/* {title} */\nstatic void {prefix}_{name}({', '.join(taken)})\n{{\n{body.text}}}"


def _taken(prefix: str, structure: str, body: Body, *, writes: bool) -> str:
    text = _STRUCTURES[structure][0].format(prefix=prefix)
    if structure == "derived" and writes:
        return text.removeprefix("const ")
    name = text.rsplit("*", 1)[1]
    if structure in ("state", "signals") and not _assigns(body.text, name):
        return f"const {text}"
    return text


def _assigns(text: str, name: str) -> bool:
    return any(line.startswith(f"    {name}->") for line in text.splitlines())


def call(prefix: str, name: str, body: Body) -> str:
    """Call the function of a routine."""
    given = [handed for structure, (_, handed) in _STRUCTURES.items() if structure in body.uses]
    return f"{prefix}_{name}({', '.join(given)});"


def sum_of_squares(types: Types, inputs: list[Variable]) -> str:
    """The sum of the squares of the inputs; not a number, or infinite, where one of them is."""
    text = ""
    for one in inputs:
        place = f"in->{one.name}"
        text = f"fma{types.suffix}({place}, {place}, {text})" if text else f"{place} * {place}"
    return text


def condition(types: Types, one: Variable) -> str:
    """Say in C that a parameter is in its range."""
    bounds, place = one.range, f"p->{one.name}"
    if bounds.minimum is None and bounds.maximum is None and not bounds.infinite:
        return f"(fabs{types.suffix}({place}) <= {types.largest})"
    low = f"-{types.largest}" if bounds.minimum is None else types.literal(bounds.minimum)
    conditions = [f"({place} {'>' if bounds.above else '>='} {low})"]
    if bounds.maximum is not None:
        high = types.literal(bounds.maximum)
        conditions.append(f"({place} {'<' if bounds.below else '<='} {high})")
    elif not bounds.infinite:
        conditions.append(f"({place} <= {types.largest})")
    return f"({' && '.join(conditions)})" if len(conditions) > 1 else conditions[0]
