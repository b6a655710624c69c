"""FMUs that are exported, loaded and called through FMPy, the same for both versions."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave

import breakaway as bk

VERSIONS = ("2", "3")
WHATS = ("controller", "plant", "loop")


@cache
def impacts() -> bk.Scenario:
    """A trial's scenario: timed impacts, sensors with noise and delay, a force actuator."""
    parts, method = bk.load_population("seized_parts"), bk.load_method("timed_impacts")
    trial = bk.run_trial(parts, method, runs=range(1), seed=4)
    return trial.scenario(0).with_({"trace.every_samples": 1, "timing.duration_s": 0.05})


def paper(periods: int = 2000) -> bk.Scenario:
    """The paper's loop, shortened."""
    scenario = bk.load_scenario("paper_as_computed")
    changes = {"trace.every_samples": 1}
    changes["timing.duration_s"] = periods * scenario.timing.control_period_s
    return scenario.with_(changes)


def needs_compiler() -> None:
    if not any(shutil.which(name) for name in ("cc", "gcc", "clang")):
        pytest.skip("needs a C compiler")


class Exported:
    """An FMU that is unpacked."""

    def __init__(self, scenario: bk.Scenario, what: str, fmi: str, folder: Path) -> None:
        needs_compiler()
        self.fmi, self.what = fmi, what
        self.path = folder / f"{what}{fmi}.fmu"
        self.written = bk.export_fmu(scenario, what=what, fmi=fmi, out=self.path)
        self.described = fmpy.read_model_description(str(self.path))
        self.folder = folder / f"{what}{fmi}"
        fmpy.extract(str(self.path), unzipdir=str(self.folder))
        self.references = {
            one.name: one.valueReference for one in self.described.modelVariables if one.name
        }
        self.inputs, self.outputs = (
            [one.name for one in self.described.modelVariables if one.causality == causality]
            for causality in ("input", "output")
        )

    def instance(self, name: str = "one", token: str | None = None) -> Unit:
        return Unit(self, name, token)


class Unit:
    """An instance."""

    def __init__(self, exported: Exported, name: str, token: str | None) -> None:
        self.exported = exported
        self.references = exported.references
        kind = FMU2Slave if exported.fmi == "2" else FMU3Slave
        described = exported.described
        self.slave: Any = kind(
            guid=token or described.guid,
            modelIdentifier=described.coSimulation.modelIdentifier,
            unzipDirectory=str(exported.folder),
            instanceName=name,
        )
        self.told: list[str] = []
        self._instantiate()

    def _instantiate(self) -> None:
        if self.exported.fmi == "2":

            def log(_env: Any, _name: bytes, _status: int, _category: bytes, text: bytes) -> None:
                self.told.append(text.decode())

            self.callbacks = fmi2CallbackFunctions()
            self.callbacks.logger = fmi2CallbackLoggerTYPE(log)
            self.slave.instantiate(callbacks=self.callbacks)
        else:

            def say(_env: Any, _status: int, _category: bytes, text: bytes) -> None:
                self.told.append(text.decode())

            self.slave.instantiate(logMessage=say)

    def start(self, **values: float) -> Unit:
        """Set what is given, then initialize."""
        for name, value in values.items():
            self[name] = value
        return self.initialize()

    def initialize(self, *, stop: float | None = None) -> Unit:
        if self.exported.fmi == "2":
            self.slave.setupExperiment(startTime=0.0, stopTime=stop)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=0.0, stopTime=stop)
        self.slave.exitInitializationMode()
        return self

    def __setitem__(self, name: str, value: float) -> None:
        if name in ("seed", "run"):
            set_ = self.slave.setInteger if self.exported.fmi == "2" else self.slave.setUInt64
        else:
            set_ = self.slave.setReal if self.exported.fmi == "2" else self.slave.setFloat64
        set_([self.references[name]], [value])

    def __getitem__(self, name: str) -> float:
        if name in ("seed", "run"):
            get = self.slave.getInteger if self.exported.fmi == "2" else self.slave.getUInt64
        else:
            get = self.slave.getReal if self.exported.fmi == "2" else self.slave.getFloat64
        return get([self.references[name]])[0]

    def step(self, time: float, size: float) -> None:
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def outputs(self) -> list[float]:
        references = [self.references[name] for name in self.exported.outputs]
        get = self.slave.getReal if self.exported.fmi == "2" else self.slave.getFloat64
        return list(get(references))

    def run(self, first: int, count: int, period: float) -> np.ndarray:
        """Outputs after each of some periods."""
        rows = []
        for k in range(first, first + count):
            self.step(k * period, period)
            rows.append(self.outputs())
        return np.array(rows)

    def save(self) -> Any:
        return self._call("getFMUstate", "getFMUState")()

    def restore(self, state: Any) -> None:
        self._call("setFMUstate", "setFMUState")(state)

    def drop(self, state: Any) -> None:
        self._call("freeFMUstate", "freeFMUState")(state)

    def to_bytes(self, state: Any) -> bytes:
        return self._call("serializeFMUstate", "serializeFMUState")(state)

    def from_bytes(self, data: bytes) -> Any:
        return self._call("deSerializeFMUstate", "deserializeFMUState")(data)

    def _call(self, two: str, three: str) -> Any:
        return getattr(self.slave, two if self.exported.fmi == "2" else three)

    def close(self) -> None:
        self.slave.freeInstance()
