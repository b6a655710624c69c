"""Functions that an FMI library must have and an exported unit has no use for."""

from __future__ import annotations

import re

_MANY = "const {f}ValueReference references[], size_t count, "
_ARRAYS = "Float32 Int8 UInt8 Int16 UInt16 Int32 UInt32 Int64 Boolean String"
_DERIVATIVE = (
    "const {f}ValueReference unknowns[], size_t count, "
    "const {f}ValueReference knowns[], size_t known_count, "
)
_SENSITIVITY = _DERIVATIVE + (
    "const {f}Float64 seed[], size_t seed_count, {f}Float64 values[], size_t value_count"
)
_COUNTER = "const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]"

_FMI2 = {
    "GetBoolean": _MANY + "{f}Boolean values[]",
    "SetBoolean": _MANY + "const {f}Boolean values[]",
    "GetString": _MANY + "{f}String values[]",
    "SetString": _MANY + "const {f}String values[]",
    "GetDirectionalDerivative": _DERIVATIVE + "const {f}Real seed[], {f}Real values[]",
    "SetRealInputDerivatives": _MANY + "const {f}Integer orders[], const {f}Real values[]",
    "GetRealOutputDerivatives": _MANY + "const {f}Integer orders[], {f}Real values[]",
    "CancelStep": "",
    "GetStatus": "const {f}StatusKind kind, {f}Status *value",
    "GetIntegerStatus": "const {f}StatusKind kind, {f}Integer *value",
    "GetStringStatus": "const {f}StatusKind kind, {f}String *value",
}

_FMI3 = {
    **{f"Get{one}": _MANY + f"{{f}}{one} values[], size_t places" for one in _ARRAYS.split()},
    **{f"Set{one}": _MANY + f"const {{f}}{one} values[], size_t places" for one in _ARRAYS.split()},
    "GetBinary": _MANY + "size_t sizes[], {f}Binary values[], size_t places",
    "SetBinary": _MANY + "const size_t sizes[], const {f}Binary values[], size_t places",
    "GetClock": _MANY + "{f}Clock values[]",
    "SetClock": _MANY + "const {f}Clock values[]",
    "GetNumberOfVariableDependencies": "{f}ValueReference reference, size_t *number",
    "GetVariableDependencies": "{f}ValueReference reference, size_t elements[], "
    "{f}ValueReference independents[], size_t element_of[], {f}DependencyKind kinds[], size_t size",
    "GetDirectionalDerivative": _SENSITIVITY,
    "GetAdjointDerivative": _SENSITIVITY,
    "EnterEventMode": "",
    "EnterConfigurationMode": "",
    "ExitConfigurationMode": "",
    "GetIntervalDecimal": _MANY + "{f}Float64 intervals[], {f}IntervalQualifier qualifiers[]",
    "GetIntervalFraction": _MANY + "{f}UInt64 counters[], {f}UInt64 resolutions[], "
    "{f}IntervalQualifier qualifiers[]",
    "GetShiftDecimal": _MANY + "{f}Float64 shifts[]",
    "GetShiftFraction": _MANY + "{f}UInt64 counters[], {f}UInt64 resolutions[]",
    "SetIntervalDecimal": _MANY + "const {f}Float64 intervals[]",
    "SetIntervalFraction": _MANY + _COUNTER,
    "SetShiftDecimal": _MANY + "const {f}Float64 shifts[]",
    "SetShiftFraction": _MANY + _COUNTER,
    "EvaluateDiscreteStates": "",
    "UpdateDiscreteStates": "{f}Boolean *again, {f}Boolean *terminate, {f}Boolean *nominals, "
    "{f}Boolean *values, {f}Boolean *has_next, {f}Float64 *next_s",
    "EnterContinuousTimeMode": "",
    "CompletedIntegratorStep": "{f}Boolean no_set_before, {f}Boolean *event, {f}Boolean *terminate",
    "SetTime": "{f}Float64 time_s",
    "SetContinuousStates": "const {f}Float64 states[], size_t size",
    "GetContinuousStateDerivatives": "{f}Float64 derivatives[], size_t size",
    "GetEventIndicators": "{f}Float64 indicators[], size_t size",
    "GetContinuousStates": "{f}Float64 states[], size_t size",
    "GetNominalsOfContinuousStates": "{f}Float64 nominals[], size_t size",
    "GetNumberOfEventIndicators": "size_t *number",
    "GetNumberOfContinuousStates": "size_t *number",
    "EnterStepMode": "",
    "GetOutputDerivatives": _MANY + "const {f}Int32 orders[], {f}Float64 values[], size_t places",
    "ActivateModelPartition": "{f}ValueReference clock, {f}Float64 time_s",
}


def absent(fmi: str) -> list[tuple[str, list[tuple[str, str]], str]]:
    """Give name, arguments (name and declaration) and what counts the variables asked for.

    Asked for no variables, a function has nothing to refuse; without such a count it always does.
    """
    first = "fmi2Component c" if fmi == "2" else "fmi3Instance c"
    found = []
    for name, rest in (_FMI2 if fmi == "2" else _FMI3).items():
        declared = ", ".join([first, rest] if rest else [first]).replace("{f}", f"fmi{fmi}")
        arguments = [(_name(one), one) for one in declared.split(", ")]
        counted = any(one == "count" for one, _ in arguments)
        found.append((f"fmi{fmi}{name}", arguments, "count" if counted else "1u"))
    return found


def _name(declaration: str) -> str:
    return str(re.findall(r"\w+", declaration)[-1])
