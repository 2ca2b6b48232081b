"""Options that many commands share, each with its words of help."""

from enum import Enum
from pathlib import Path
from typing import Annotated, Optional

import typer

SceneName = Annotated[str, typer.Option("--scene", metavar="NAME_OR_FILE", help="Catalogue scene or path of a .toml file.")]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder that receives a folder per scene.")]
Set = Annotated[Optional[list[str]], typer.Option("--set", metavar="KEY=VALUE",
                help='Override, repeatable: --set payload.mass="9 kg"; --set friction=absent drops a table.')]
Conditions = Annotated[Optional[list[str]], typer.Option("--condition", metavar="NAME",
                       help="Named condition of the scene, repeatable; default: all.")]
OnWalls = Annotated[bool, typer.Option("--walls", help="Surrogate on compliant walls: pads press on the static compliance of the "
                                       "rails, condensed from the reference's stiffness matrix in seconds, nothing fitted; by far "
                                       "closer to the reference than springs.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on standard output.")]
ElementSize = Annotated[Optional[float], typer.Option("--element-size", metavar="MM", min=0.05,
                        help="Element size of the reference in mm; default 2 (scene tiny: 8). What needs many runs or "
                        "differences of runs takes twice that.")]
Workers = Annotated[Optional[int], typer.Option("--workers", metavar="N", min=1, help="Runs side by side; default: all cores.")]
CheckpointEvery = Annotated[Optional[str], typer.Option("--checkpoint-every", metavar="TIME",
                            help='How often a run of the reference is kept beside its result-to-be: 30s, "5 min"; default: 60 s.')]
Resume = Annotated[bool, typer.Option("--resume/--no-resume",
                   help="Let a run of the reference that was interrupted go on from where it was kept last, to the same result.")]


class Fidelity(str, Enum):
    """The two models."""

    highfi = "highfi"
    lowfi = "lowfi"


class Sampling(str, Enum):
    """Ways to draw the cases of an ensemble."""

    random = "random"
    latin_hypercube = "latin-hypercube"
    sobol = "sobol"
