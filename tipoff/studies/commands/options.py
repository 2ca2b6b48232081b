"""Options that many commands share, each with its words of help."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


# Written out as in ``mechanics.models``, which loads too much for ``--help`` to answer at once.
class ModelName(StrEnum):
    """All models."""

    compliant = "compliant"
    springs = "springs"
    finite_elements = "finite-elements"


class SurrogateName(StrEnum):
    """All models but the reference."""

    compliant = "compliant"
    springs = "springs"


SceneName = Annotated[
    str,
    typer.Option(
        "--scene", metavar="NAME_OR_FILE", help="Catalogue scene or path of a .toml file."
    ),
]
Out = Annotated[
    Path, typer.Option("--out", metavar="DIR", help="Folder that receives a folder per scene.")
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help='Override, repeatable: --set payload.mass="9 kg"; --set friction=absent drops a '
        "table.",
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
    "compliant (default): rigid bodies on the rail's static compliance, condensed from "
    "the finite elements; "
)
Model = Annotated[
    ModelName | None,
    typer.Option(
        "--model",
        help=_COMPLIANT + "springs: one spring and damper at each pad face, "
        "the paper's method; finite-elements: the reference.",
    ),
]
Surrogate = Annotated[
    SurrogateName | None,
    typer.Option(
        "--model",
        help=_COMPLIANT + "springs: calibrated springs and dampers "
        "at the pad faces, the paper's method.",
    ),
]
Modes = Annotated[
    int | None,
    typer.Option(
        "--modes",
        metavar="N",
        min=0,
        help="Modes of each rail that vibrate, with --model compliant; default: 0.",
    ),
]
CalibrationFile = Annotated[
    Path | None,
    typer.Option(
        "--calibration",
        metavar="FILE",
        help="calibration.toml of tipoff "
        "calibrate, with --model springs; default: the scene's own constants.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on standard output.")]
ElementSize = Annotated[
    float | None,
    typer.Option(
        "--element-size",
        metavar="MM",
        min=0.05,
        help="Element size of the reference in mm; default 2 (scene tiny: 8). What needs many runs "
        "or "
        "differences of runs takes twice that.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", min=1, help="Runs side by side; default: all cores."),
]
CheckpointEvery = Annotated[
    str | None,
    typer.Option(
        "--checkpoint-every",
        metavar="TIME",
        help='How often a run of the reference is kept beside its result-to-be: 30s, "5 min"; '
        "default: 60 s.",
    ),
]
Resume = Annotated[
    bool,
    typer.Option(
        "--resume/--no-resume",
        help="Let a run of the reference that was interrupted go on from where it was kept last, "
        "to the same result.",
    ),
]


class Sampling(StrEnum):
    """Ways to draw the cases of an ensemble."""

    random = "random"
    latin_hypercube = "latin-hypercube"
    sobol = "sobol"
