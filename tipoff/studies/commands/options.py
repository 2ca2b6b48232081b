"""Options that many commands share, with their help."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

_DEGREES = ("1", "2", "3", "4", "5")


def modes_of(text: str) -> int | str:
    """A number of modes, or ``auto``; raises BadParameter."""
    if text == "auto" or text.isdecimal():
        return text if text == "auto" else int(text)
    raise typer.BadParameter(f"{text!r}: a whole number from zero, or auto")


def degree_of(text: str) -> int | str:
    """A degree of patterns, or ``auto``; raises BadParameter."""
    if text == "auto" or text in _DEGREES:
        return text if text == "auto" else int(text)
    raise typer.BadParameter(f"{text!r}: {', '.join(_DEGREES)}, or auto")


def scene_names(incomplete: str) -> list[str]:
    """Names of the catalogue and scene files that begin with ``incomplete``, for the shell."""
    catalog = Path(__file__).resolve().parents[2] / "scenes" / "catalog"
    names = sorted(path.stem for path in catalog.glob("*.toml"))
    files = sorted(f"{path}{'/' if path.is_dir() else ''}" for path in _beginning_with(incomplete))
    return [name for name in names if name.startswith(incomplete)] + files


def condition_names(context: typer.Context, incomplete: str) -> list[str]:
    """Conditions of the scene on the command line that begin with the last name of ``incomplete``,
    for the shell; none if the scene cannot be read."""
    from tipoff import scenes

    try:
        scene = scenes.load(context.params.get("scene") or "reference")
    except scenes.SceneError:
        return []
    before, comma, last = incomplete.rpartition(",")
    return [f"{before}{comma}{name}" for name in scene.conditions if name.startswith(last)]


def _beginning_with(incomplete: str) -> list[Path]:
    folder = Path(incomplete or ".")
    folder = folder if incomplete.endswith("/") else folder.parent
    return [
        path
        for path in (folder.iterdir() if folder.is_dir() else ())
        if str(path).startswith(incomplete) and (path.is_dir() or path.suffix == ".toml")
    ]


SceneName = Annotated[
    str,
    typer.Option(
        "--scene",
        metavar="NAME_OR_FILE",
        autocompletion=scene_names,
        help="Catalogue scene or path of a .toml file.",
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
        help='Change a value: --set payload.mass="9 kg", --set studies.element_size="4 mm". --set '
        "friction=absent removes a table. Repeatable.",
    ),
]
Conditions = Annotated[
    list[str] | None,
    typer.Option(
        "--condition",
        metavar="NAME",
        autocompletion=condition_names,
        help="Named condition of the scene. Repeatable, or several names with commas. Default: all.",
    ),
]
RefinedCondition = Annotated[
    str | None,
    typer.Option(
        "--condition",
        metavar="NAME",
        autocompletion=condition_names,
        help="Named condition; default: the first in agreement.refined of the scene.",
    ),
]
# The names of ``mechanics.model_names``, repeated because its import would slow ``--help`` down.
ModelName = Literal["compliant", "springs", "finite-elements"]
SurrogateName = Literal["compliant", "springs"]
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


def rate_limits(example: str, words: str) -> Any:
    """The option ``--limit`` of rates, in the form of ``exceedance.limits``; ``words`` say what is
    done with them."""
    return typer.Option(
        "--limit",
        metavar="[AXIS=]RATE",
        help=f'Limit of a rate, "x={example}", or of the total rate, "{example}"; repeatable. {words}',
    )


At = Annotated[
    Literal["exit", "settled"] | None,
    typer.Option(
        "--at",
        help="Instant of velocity and rates; default: exit if more than 1 % of the impulse comes after "
        "it, else settled.",
    ),
]
Modes = Annotated[
    str | None,
    typer.Option(
        "--modes",
        metavar="N",
        parser=modes_of,
        help="Number of vibration modes of each rail, with --model compliant; auto (default): as "
        "many as the rates need.",
    ),
]
Degree = Annotated[
    str | None,
    typer.Option(
        "--degree",
        metavar="N",
        parser=degree_of,
        help="Degree of the polynomials of pressure and displacement on a pad face, with --model "
        "compliant, from 1 to 5; default: 3. A higher one is slower, and nearer to the reference; auto: "
        "the least one whose next would hardly change the rates.",
    ),
]
Cells = Annotated[
    int | None,
    typer.Option(
        "--cells",
        metavar="N",
        min=4,
        max=100,
        help="Contact cells along each edge of a pad face, with --model compliant; 16 by default, "
        "as in the reference.",
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
Export = Annotated[
    tuple[str, Path] | None,
    typer.Option(
        "--export",
        metavar="rocketpy|csv FILE",
        help="Also write the state at exit for codes of flight, in the axes of RocketPy: rocketpy for "
        "JSON, csv for a table. The table \\[hand_over] of the scene says how the rail stands.",
    ),
]
SettledFrom = Annotated[
    str | None,
    typer.Option(
        "--settled-from",
        metavar="TIME",
        help="Start of the 2 ms window of the settled values; default: the last 2 ms of a file.",
    ),
]


_OF_FILES = {
    "--columns": (
        "QUANTITY=COLUMN",
        "Columns of time, velocity_x, rate_x, rate_y and rate_z by header or number: "
        '"time=Time, rate_x=WX, rate_y=-WZ".',
    ),
    "--units": (
        "QUANTITY=UNIT",
        'Units that a file does not state: "time=ms, velocity_x=mm/s, rate=deg/s"; of LS-DYNA '
        '"time=ms, length=mm".',
    ),
    "--body": (
        "NUMBER",
        "Node or rigid body of a file of LS-DYNA, or part of one of Adams.",
    ),
    "--axes": (
        "AXES",
        "Axes of the rates: body (of the payload), or scene (fixed). Default: scene for LS-DYNA, "
        "body for a table.",
    ),
    "--ignition": (
        "TIME",
        "Time of the ignition in a file: earlier samples are left out. Default: zero.",
    ),
}


def of_files(flag: str) -> Any:
    """An option on the layout of files with curves, in the form of ``comparison.layout``."""
    metavar, words = _OF_FILES[flag]
    help_ = f'{words} "NAME: ..." is for that file only. Repeatable.'
    return typer.Option(flag, metavar=metavar, help=help_)


Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on standard output.")]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", min=1, help="Parallel runs; default: all cores."),
]


def errors_file(default: str) -> Any:
    """A file of errors; ``default``: without the option."""
    return typer.Option(
        "--vary",
        metavar="NAME_OR_FILE",
        help=f"Distributions of errors: a .toml file, or a name of the catalogue; default: {default}.",
    )


Vary = Annotated[str | None, errors_file("studies.errors of the scene, else paper")]
Neighbours = Annotated[
    int | None,
    typer.Option(
        "--neighbours",
        metavar="N",
        min=5,
        max=10_000,
        help="Number of neighbours of each condition that is judged as a distribution: runs of the "
        "reference within 1 µm of it. A condition that is not sensitive takes a quarter of them, at "
        "least 5. Default: the number that the scene states (\\[studies]), else 32.",
    ),
]
CheckpointEvery = Annotated[
    str | None,
    typer.Option(
        "--checkpoint-every",
        metavar="TIME",
        help='Wall time between checkpoints of a run of the reference: 30s, "5 min"; default: 60 s.',
    ),
]
