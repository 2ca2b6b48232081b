"""Options that many commands share, with their help."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


def modes_of(text: str) -> int | str:
    """A number of modes, or ``auto``; raises BadParameter."""
    if text == "auto" or text.isdecimal():
        return text if text == "auto" else int(text)
    raise typer.BadParameter(f"{text!r}: a whole number from zero, or auto")


# The names of ``mechanics.models``, repeated because its import would slow ``--help`` down.
class ModelName(StrEnum):
    """All models."""

    compliant = "compliant"
    springs = "springs"
    finite_elements = "finite-elements"


class SurrogateName(StrEnum):
    """All models except the reference."""

    compliant = "compliant"
    springs = "springs"


SceneName = Annotated[
    str,
    typer.Option(
        "--scene", metavar="NAME_OR_FILE", help="Catalogue scene or path of a .toml file."
    ),
]
Out = Annotated[
    Path,
    typer.Option(
        "--out", metavar="DIR", help="Folder of the results; each scene has its own folder in it."
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help='Change of a value, repeatable: --set payload.mass="9 kg"; --set friction=absent '
        "removes a table.",
    ),
]
Conditions = Annotated[
    list[str] | None,
    typer.Option(
        "--condition",
        metavar="NAME",
        help="Named condition of the scene, repeatable; default: all.",
    ),
]
RefinedCondition = Annotated[
    str | None,
    typer.Option(
        "--condition", metavar="NAME", help="Named condition; default: the first refined one."
    ),
]
_COMPLIANT = (
    "compliant (default): rigid bodies on the static compliance of the rail, condensed from the "
    "finite elements; "
)
Model = Annotated[
    ModelName | None,
    typer.Option(
        "--model",
        help=_COMPLIANT + "springs: one spring and damper at each pad face, "
        "the method of the paper; finite-elements: the reference.",
    ),
]
Surrogate = Annotated[
    SurrogateName | None,
    typer.Option(
        "--model",
        help=_COMPLIANT + "springs: calibrated springs and dampers "
        "at the pad faces, the method of the paper.",
    ),
]
Modes = Annotated[
    str | None,
    typer.Option(
        "--modes",
        metavar="N",
        parser=modes_of,
        help="Vibration modes of each rail, with --model compliant, or auto (default): those that "
        "matter to the rates.",
    ),
]
CalibrationFile = Annotated[
    Path | None,
    typer.Option(
        "--calibration",
        metavar="FILE",
        help="Calibration written by tipoff calibrate for the same model; default: the constants "
        "of the scene.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on standard output.")]
ElementSize = Annotated[
    float | None,
    typer.Option(
        "--element-size",
        metavar="MM",
        min=0.05,
        help="Element size of the reference in mm; default 2 (scene tiny: 8). Studies of many runs "
        "and of differences of runs use twice this size.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", min=1, help="Parallel runs; default: all cores."),
]
CheckpointEvery = Annotated[
    str | None,
    typer.Option(
        "--checkpoint-every",
        metavar="TIME",
        help='Wall time between checkpoints of a run of the reference: 30s, "5 min"; default: 60 s.',
    ),
]
Resume = Annotated[
    bool,
    typer.Option(
        "--resume/--no-resume",
        help="Continue an interrupted run of the reference from its checkpoint; the result is the "
        "same.",
    ),
]


class Sampling(StrEnum):
    """Ways to draw the cases of an ensemble."""

    random = "random"
    latin_hypercube = "latin-hypercube"
    sobol = "sobol"
