"""Options that many commands share, each with its words of help."""

from enum import Enum
from pathlib import Path
from typing import Annotated, Optional

import typer

SceneName = Annotated[str, typer.Option("--scene", metavar="NAME_OR_FILE", help="Catalogue scene or path of a .toml file.")]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder that receives a folder per scene.")]
Set = Annotated[Optional[list[str]], typer.Option("--set", metavar="KEY=VALUE",
                help='Override, repeatable: --set payload.mass="9 kg"; "absent" drops a table.')]
Conditions = Annotated[Optional[list[str]], typer.Option("--condition", metavar="NAME",
                       help="Named condition of the scene, repeatable; default: all.")]
OnWalls = Annotated[bool, typer.Option("--walls", help="Surrogate on walls that give way as the statics of the rail has them, "
                                       "found from the reference's matrices in seconds, in place of a contact law to calibrate.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on standard output.")]
ElementSize = Annotated[Optional[float], typer.Option("--element-size", metavar="MM", min=0.05,
                        help="Element size of the reference in mm.")]
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
