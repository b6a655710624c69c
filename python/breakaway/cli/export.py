"""``breakaway export``: the code that was simulated, for other places."""

from __future__ import annotations

import shlex
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from breakaway.cli.help import add_command, unwrapped
from breakaway.cli.options import Joint, Json, ScenarioName
from breakaway.cli.show import busy, say, say_json, say_written

if TYPE_CHECKING:
    from breakaway.cli.overlay import Overlay

EXPORT = "Write a scenario's controller or plant as code that runs elsewhere."


export = typer.Typer(
    help=EXPORT,
    no_args_is_help=True,
    rich_markup_mode=None,
    epilog=unwrapped(
        "Examples",
        [
            "breakaway export c paper_as_computed --out rig",
            "breakaway export c my_joint.toml --what loop --out rig",
            "breakaway export fmu paper_as_computed --out rig.fmu",
        ],
    ),
)


class What(StrEnum):
    """What of a scenario is exported."""

    CONTROLLER = "controller"
    PLANT = "plant"
    LOOP = "loop"


class Real(StrEnum):
    """The real type."""

    DOUBLE = "double"
    FLOAT = "float"


class Fmi(StrEnum):
    """The version of the standard."""

    TWO = "2"
    THREE = "3"


def export_c(
    scenario: ScenarioName,
    out: Annotated[Path, typer.Option(help="Folder for the files.", metavar="DIR")],
    what: Annotated[
        What, typer.Option(help="Controller with its reference, plant, or the closed loop of both.")
    ] = What.CONTROLLER,
    real: Annotated[Real, typer.Option(help="The real type of the code.")] = Real.DOUBLE,
    joint: Joint = None,
    json: Json = False,
) -> None:
    """Write self-contained C99: header, source, test program, CMakeLists.txt, README.

    The code computes the same bits as the simulation in the same real type
    and does not allocate memory. The scenario's numbers are parameters that
    you can change at run time; its kinds and options are fixed.
    """
    from breakaway.cli.laid import laid
    from breakaway.export import export_c as write
    from breakaway.model.scenario import load_scenario

    asked, overlay = laid(load_scenario(scenario), joint)
    with busy("recording the step ..."):
        written = write(asked, what=what.value, out=out, real=real.value)
    if json:
        files = [str(path) for path in written.files]
        say_json({"what": written.what, "real": written.real, "files": files, **_joint(overlay)})
        return
    say(*(overlay.tables() if overlay else []))
    say_written(written.files)
    source, build = shlex.quote(str(out)), shlex.quote(str(out / "build"))
    say(
        f"Build and test it: cmake -S {source} -B {build} && cmake --build {build} && "
        f"ctest --test-dir {build}"
    )


def export_fmu(
    scenario: ScenarioName,
    out: Annotated[Path, typer.Option(help="The file, such as rig.fmu.", metavar="FILE.fmu")],
    what: Annotated[
        What, typer.Option(help="Controller with its reference, plant, or the closed loop of both.")
    ] = What.CONTROLLER,
    fmi: Annotated[Fmi, typer.Option(help="Version of the FMI standard.")] = Fmi.THREE,
    joint: Joint = None,
    json: Json = False,
) -> None:
    """Write a co-simulation FMU: sources, and the library for this host.

    It computes the same bits as the simulation. A communication step is a whole
    number of control periods. Building the library needs a C compiler: cc, gcc
    or clang on PATH, or the one that CC names. Without one, the FMU holds only
    sources.
    """
    from breakaway.cli.laid import laid
    from breakaway.export import export_fmu as write
    from breakaway.model.scenario import load_scenario

    asked, overlay = laid(load_scenario(scenario), joint)
    with busy("recording the step ..."):
        written = write(asked, what=what.value, fmi=fmi.value, out=out)
    if json:
        told = {"what": written.what, "fmi": written.fmi, "file": str(written.path)}
        say_json({**told, "binary": written.binary, "note": written.note, **_joint(overlay)})
        return
    say(*(overlay.tables() if overlay else []))
    say(f"wrote {written.path}: FMI {written.fmi}, {written.binary or written.note}")


def _joint(overlay: Overlay | None) -> dict[str, object]:
    return {"joint": overlay.to_dict()} if overlay else {}


add_command(
    export,
    export_c,
    "breakaway export c paper_as_computed --what controller --out rig",
    "breakaway export c my_joint.toml --what loop --real float --out rig",
    name="c",
)
add_command(
    export,
    export_fmu,
    "breakaway export fmu paper_as_computed --out rig.fmu",
    "breakaway export fmu my_joint.toml --what plant --fmi 2 --out plant.fmu",
    name="fmu",
)
