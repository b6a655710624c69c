"""Export a controller, a plant or a loop as C99."""

from __future__ import annotations

from dataclasses import dataclass
from json import dumps
from pathlib import Path
from typing import Any

import numpy as np

from breakaway import _core
from breakaway.base.arguments import check_arguments
from breakaway.base.output import output_folder
from breakaway.base.ownership import C_SOURCES
from breakaway.errors import ScenarioError
from breakaway.export import c_text
from breakaway.export.interface import Real, Variable, What
from breakaway.export.recording import Recording, record
from breakaway.export.templating import fill
from breakaway.export.vectors import COLUMNS, STEPS, bits, likely_inputs, reference
from breakaway.model.scenario.scenario import Scenario
from breakaway.run.resolution import resolve

TITLES = {"controller": "Controller", "plant": "Plant", "loop": "Loop"}
"""What is exported -> what it is called."""

ROUTINES = {
    "compute": "One control period.",
    "begin": "What begins a control period.",
    "move": "One integration step: the actuator drives, the joint is solved, the actuator yields.",
    "end": "What ends a control period.",
    "show": "What the sensors show.",
}
"""Name of a routine -> what it does."""


@dataclass(frozen=True)
class ExportedC:
    """What was written."""

    what: What
    real: Real
    files: tuple[Path, ...]
    """The files, in alphabetical order."""


def export_c(
    scenario: Scenario, *, what: What = "controller", out: str | Path, real: Real = "double"
) -> ExportedC:
    """Write a part of a scenario as self-contained C99.

    The code computes the same bits as the simulation in the same real type, and comes with a test
    program that proves it. Two exports of the same scenario are the same, byte for byte.

    Parameters
    ----------
    scenario : Scenario
        What is exported. Its kinds and options are fixed in the code; its numbers are parameters
        that may be changed at run time. What is switched off, such as a derivative filter of 0 s,
        has no parameter.
    what : {"controller", "plant", "loop"}
        Reference, controller and watch; or actuator, joint, part and sensors; or both.
    out : path
        Folder for the files, made if it is missing. Those of an earlier export are replaced.
    real : {"double", "float"}
        The real type.

    Returns
    -------
    ExportedC

    Raises
    ------
    ScenarioError
        It is not a scenario, `what` or `real` is not known, the controller cannot be designed for
        this joint, or a number is out of its range as float.
    OutputError
        The folder cannot be written, holds a result of another kind, or files of others under
        these names.

    Examples
    --------
    >>> import tempfile
    >>> import breakaway as bk
    >>> scenario = bk.load_scenario("paper_as_computed")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in bk.export_c(scenario, out=folder).files][:4]
    ['CMakeLists.txt', 'README.md', 'controller.c', 'controller.h']

    """
    check_arguments(export_c, locals(), ScenarioError)
    recording = record(resolve(scenario), what, real)
    folder = Path(out)
    texts = c_texts(recording)
    with output_folder(folder, C_SOURCES, texts) as staging:
        for name, text in texts.items():
            (staging / name).write_text(text, encoding="utf-8", newline="\n")
    return ExportedC(what, real, tuple(folder / name for name in sorted(texts)))


def c_texts(recording: Recording) -> dict[str, str]:
    """Compose the files, by name."""
    prefix = recording.what
    context = _context(recording)
    return {
        f"{prefix}.h": fill("step.h.j2", **context),
        f"{prefix}.c": fill("step.c.j2", **context),
        f"test_{prefix}.c": fill("test.c.j2", **context, **_vectors(recording)),
        "CMakeLists.txt": fill("CMakeLists.txt.j2", **context),
        "README.md": fill("README.md.j2", **context),
        "interface.json": dumps(interface(recording), indent=2, allow_nan=False) + "\n",
    }


def draws(recording: Recording) -> bool:
    """Whether the code draws random numbers: for the paper's random factor, or for noise."""
    return _redrawn(recording) or _noisy(recording)


def _redrawn(recording: Recording) -> bool:
    return "draw" in recording.signals


def _context(recording: Recording) -> dict[str, Any]:
    prefix, types, scenario = recording.what, c_text.types_of(recording), recording.scenario
    watched = scenario.watch is not None and prefix == "controller"
    bodies = {routine.name: routine.body for routine in recording.routines}
    text = recording.derive.text + "".join(body.text for body in bodies.values())
    return {
        "prefix": prefix,
        "name": scenario.name,
        "titles": TITLES,
        "version": _core.__version__,
        "real": recording.real,
        "suffix": types.suffix,
        "largest": types.largest,
        "bits_type": types.bits,
        "mantissa": types.mantissa,
        "zero": types.literal(0.0),
        "period": scenario.timing.control_period_s,
        "period_name": "timing_control_period_s",
        "parameters": recording.parameters,
        "inputs": recording.inputs,
        "outputs": recording.outputs,
        "states": recording.states,
        "derived": recording.derived,
        "derive": recording.derive,
        "signals": recording.signals,
        "routines": recording.routines,
        "routine_titles": ROUTINES,
        "helpers": recording.helpers,
        "uses": recording.uses,
        "has_bool": "const bool " in text,
        "show": bodies.get("show"),
        "step": _step(recording),
        "watched": watched,
        "squares": c_text.sum_of_squares(types, recording.inputs),
        "small_square": types.literal(_smallest_limit(recording) ** 2),
        "goes_on": _goes_on(prefix, watched=watched),
        "summary": _summary(recording),
        "literal": types.literal,
        "member": lambda one, _: c_text.member(prefix, one),
        "condition": lambda one: c_text.condition(types, one),
        "function": lambda name, body, title: c_text.function(prefix, name, body, title),
        "call": lambda name, body, bound=False: c_text.call(prefix, name, body),  # noqa: ARG005
        **_draws(recording),
    }


def _smallest_limit(recording: Recording) -> float:
    """The magnitude that is allowed for every input."""
    return min((one.range.maximum or 0.0 for one in recording.inputs), default=0.0)


def _goes_on(prefix: What, *, watched: bool) -> str:
    """The condition under which a step is computed: a watch wants to see what is no number."""
    if watched:
        return f"status != {prefix.upper()}_INPUT_OUTSIDE_LIMITS"
    return f"status == {prefix.upper()}_OK"


def _draws(recording: Recording) -> dict[str, Any]:
    disturbance = recording.scenario.disturbance
    return {
        "draws": draws(recording),
        "redrawn": _redrawn(recording),
        "law": disturbance.law,
        "band_limited": disturbance.law == "band_limited",
        "noisy": _noisy(recording),
        "seed": recording.scenario.seed,
        "two_to_minus_52": repr(2.0**-52),
        "per_deviation": repr(1.0 / 209.02152903595637),
        "two_to_minus_53": repr(2.0**-53),
        "beyond": repr(3.167124183311992e-5),
        "bias_less_root": f"UINT64_C(0x{_BIAS_LESS_ROOT:016X})",
        "variate_arguments": "p, r, " if disturbance.law == "band_limited" else "",
        "draw_functions": [
            (name, arguments)
            for name, arguments, _ in recording.draw_functions
            if name in ("ln_of_parts", "quantile_middle", "quantile_tail")
        ],
        "draw_texts": {name: text for name, _, text in recording.draw_functions},
        "draw_titles": DRAW_TITLES,
    }


_BIAS_LESS_ROOT = 0x3FF0_0000_0000_0000 - 0x3FE6_A09E_667F_3BCD
"""Bits of 1 less those of the root of 1/2."""

DRAW_TITLES = {
    "ln_of_parts": "ln(2^k m) = k ln 2 + 2 artanh s, s = (m - 1) / (m + 1).",
    "quantile_middle": "The quantile where it is q from 1/2, at most 0.425.",
    "quantile_tail": "The distance of the quantile from 0 in a tail, by r = sqrt(-ln p).",
    "kept": "What low-passed noise keeps from one draw to the next: exp(-2 pi f hold).",
}
"""Functions of the random draws -> what they do."""


def _noisy(recording: Recording) -> bool:
    return any(name.startswith("noise_") for name in recording.signals)


def _summary(recording: Recording) -> list[str]:
    """Say what the code is made of."""
    scenario = recording.scenario
    controller = [
        f"reference: {scenario.reference.kind}",
        f"controller: {scenario.controller.kind}",
    ]
    plant = [
        f"actuator: {scenario.actuator.kind}",
        f"joint: {scenario.joint.law}",
        f"disturbance: {scenario.disturbance.kind}, {scenario.disturbance.law}",
        f"integrator: {scenario.timing.integrator}, "
        f"{scenario.timing.steps_per_period} step(s) in a period",
    ]
    if scenario.watch is not None:
        controller.append("watch: stops at a measurement that cannot be true")
    if scenario.sensors is not None:
        plant.append("sensors: with bandwidth, noise, steps and delay, where they have them")
    if scenario.timing.one_sample_delay:
        plant.append("delay: a command takes effect one sample later")
    made = {"controller": controller, "plant": plant, "loop": controller + plant}
    return made[recording.what]


def _step(recording: Recording) -> str:
    """The statements of a step."""
    prefix = recording.what
    lines = []
    if _redrawn(recording):
        lines.append(f"w->draw = {prefix}_draw(&self->parameters, &self->state.draws);")
    if _noisy(recording):
        sample = "self->state.draws.sample" + (" + 1u" if prefix == "plant" else "")
        lines.append(f"{prefix}_noise(&self->parameters, {sample}, w);")
    for routine in recording.routines:
        call = c_text.call(prefix, routine.name, routine.body)
        if routine.times == 1:
            lines.append(call)
            continue
        lines += [f"for (int n = 0; n < {routine.times}; n++) {{", f"    {call}", "}"]
    if draws(recording):
        lines.append("self->state.draws.sample += 1u;")
    return "\n".join(lines)


def _vectors(recording: Recording) -> dict[str, Any]:
    """Recorded steps, as rows of C."""
    what, real = recording.what, recording.real
    inputs = np.zeros((STEPS, 3)) if what == "loop" else likely_inputs(recording)
    given = reference(recording.scenario, what, real, inputs)
    columns = [COLUMNS[what].index(one.name) for one in recording.inputs]
    outputs = np.column_stack([given[one.name] for one in recording.outputs])
    return {
        "steps": STEPS,
        "input_rows": _rows(inputs[:, columns], real) if recording.inputs else "",
        "output_rows": _rows(outputs, real),
    }


def _rows(values: np.ndarray[Any, np.dtype[np.float64]], real: Real) -> str:
    return ",\n".join(f"    {{{', '.join(bits(row, real))}}}" for row in values)


def interface(recording: Recording) -> dict[str, Any]:
    """Describe the code for other programs, such as one that packs it into an FMU."""
    scenario = recording.scenario
    return {
        "breakaway_version": _core.__version__,
        "scenario": scenario.name,
        "description": scenario.description,
        "what": recording.what,
        "prefix": recording.what,
        "real": recording.real,
        "control_period_s": scenario.timing.control_period_s,
        "control_period_parameter": "timing_control_period_s",
        "draws": draws(recording),
        "seed": scenario.seed if draws(recording) else None,
        "first_output_from_init": recording.what == "plant",
        "parameters": [_told(one) for one in recording.parameters],
        "inputs": [_told(one) for one in recording.inputs],
        "outputs": [_told(one) for one in recording.outputs],
        "states": [_told(one) for one in recording.states],
    }


def _told(one: Variable) -> dict[str, Any]:
    bounds = one.range
    return {
        "name": one.name,
        "path": one.path,
        "unit": one.unit,
        "description": one.description,
        "default": "Infinity" if np.isinf(one.value) else one.value,
        "minimum": bounds.minimum,
        "minimum_excluded": bounds.above,
        "maximum": bounds.maximum,
        "maximum_excluded": bounds.below,
        "may_be_infinite": bounds.infinite,
    }
