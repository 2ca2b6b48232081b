"""``tipoff new``."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from tipoff.studies.commands.options import Json
from tipoff.studies.commands.running import Output, guarded, quantity

if TYPE_CHECKING:
    from tipoff.faults import SceneError
    from tipoff.formats.designs.openrocket import Design

# option, unit, question, answer if none is given
_ASKED = {
    "mass": ("kg", "Mass of the payload", "9.9 kg"),
    "size": ("m", "Size of the payload along X, Y and Z", "350 mm, 200 mm, 200 mm"),
    "rail_length": ("m", "Travel along the rail", "220 mm"),
    "clearance": ("m", "Clearance between each pad and its wall", "0.25 mm"),
    "thrust": ("N", "Peak of the thrust", "6 kN"),
    "burn_time": ("s", "Time in which the thrust rises and falls", "24 ms"),
}
_ROD = ("m", "Diameter of a launch rod", "6.35 mm")


def _option(name: str) -> typer.models.OptionInfo:
    _, question, default = _ASKED[name]
    return typer.Option(
        _option_name(name), metavar="QUANTITY", help=f"{question}; default: {default}."
    )


def _option_name(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def new(
    file: Annotated[Path, typer.Argument(metavar="FILE.toml", help="The scene file to write.")],
    design: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[DESIGN.ork [SIMULATION.csv]]",
            help="With --rocket: a design of OpenRocket, saved with the results of a simulation, or the design and "
            "the table that OpenRocket exports from a simulation. They give mass, mass centre and inertia at "
            "launch, buttons or lugs, rail and thrust.",
        ),
    ] = None,
    mass: Annotated[str | None, _option("mass")] = None,
    size: Annotated[str | None, _option("size")] = None,
    rail_length: Annotated[str | None, _option("rail_length")] = None,
    clearance: Annotated[str | None, _option("clearance")] = None,
    thrust: Annotated[str | None, _option("thrust")] = None,
    burn_time: Annotated[str | None, _option("burn_time")] = None,
    thrust_curve: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="File of a thrust curve, instead of --thrust and --burn-time. The scene refers to the "
            "file.",
        ),
    ] = None,
    pads: Annotated[
        int | None,
        typer.Option(
            metavar="4|8|12...",
            help="Number of pads on all four rails: 4 is one long pad on each rail, 8 is two pads "
            "on each rail, and so on; default: 8.",
        ),
    ] = None,
    deployer: Annotated[
        Literal["1u", "1.5u", "2u", "3u", "6u", "12u", "16u"] | None,
        typer.Option(
            "--deployer",
            help="Write a CubeSat of this size in a deployer with a spring, instead of a launcher. Takes "
            "--mass, --clearance, and --thrust for the force of the spring at zero travel.",
        ),
    ] = None,
    rocket: Annotated[
        bool,
        typer.Option(
            "--rocket",
            help="Write a rocket with two buttons in the slot of a T-slot rail, instead of a launcher. Takes "
            '--mass, --size for its length and diameter ("1.6 m, 80 mm"), --rail-length, --clearance and '
            "--thrust-curve for its motor.",
        ),
    ] = False,
    rod: Annotated[
        str | None,
        typer.Option(
            metavar="QUANTITY",
            help="With --rocket: lugs on a round rod of this diameter, in place of buttons.",
        ),
    ] = None,
    json_: Json = False,
) -> None:
    """Write a commented scene of your own launcher from a few numbers; it runs as it is.

    On a terminal, the command asks for each number that is not given. All other values are assumed;
    the table provenance of the file marks them as assumed.

      tipoff new my_launcher.toml --mass "12 kg" --thrust "4 kN"
      tipoff new my_deployer.toml --deployer 3u --mass "4.5 kg"
      tipoff new my_rocket.toml --rocket --mass "6 kg"
      tipoff new my_rocket.toml --rocket --rod "6.35 mm"
      tipoff new my_rocket.toml --rocket design.ork
      tipoff new my_rocket.toml --rocket design.ork simulation.csv
      tipoff new measured.toml --thrust-curve firing.csv
      tipoff run --scene my_launcher.toml

    The file of --thrust-curve is one of: {formats of thrusts}.
    """
    given: dict[str, str | None] = {
        "mass": mass,
        "size": size,
        "rail_length": rail_length,
        "clearance": clearance,
        "thrust": thrust,
        "burn_time": burn_time,
    }
    kind = deployer or ("rocket" if rocket else None)
    nothing = all(value is None for value in (*given.values(), thrust_curve, pads, kind, rod))
    if nothing and sys.stdin.isatty():
        given = {
            name: typer.prompt(question, default=default)
            for name, (_, question, default) in _ASKED.items()
        }

    both = bool(deployer and rocket)

    def work() -> Output:
        from tipoff.faults import together
        from tipoff.files import write_text
        from tipoff.studies.new_scene import from_catalogue, template

        _, (text, beside_it) = together(
            lambda: _require_new(file),
            lambda: (
                _of_design(
                    file,
                    design,
                    [*given.values(), thrust_curve, pads, rod],
                    rocket and not deployer,
                )
                if design
                else _from_catalogue(
                    file,
                    kind,
                    given | {"rod": rod},
                    thrust_curve,
                    {"pads": pads, "rocket": both or None},
                )
                if kind
                else (
                    template.text(file.stem, _numbers(given, thrust_curve, pads, rod), file.parent),
                    {},
                )
            ),
        )
        with from_catalogue.written(file.parent, beside_it):
            _require_scene(text, file)
            write_text(file, text)
        return Output({"scene": file.stem, "file": str(file), "text": text}, _next)

    guarded(work, json_)


def _from_catalogue(
    file: Path,
    kind: str,
    given: dict[str, str | None],
    thrust_curve: Path | None,
    others: dict[str, object],
) -> tuple[str, dict[str, str]]:
    """The scene of a ``kind`` of the catalogue, and text by name of the files that it names. Raises
    SceneError, every fault listed."""
    from tipoff.faults import SceneError
    from tipoff.studies.new_scene import deployer, from_catalogue, rocket, template

    like = from_catalogue.KINDS[kind]
    beside = [option for option, value in (given | others).items() if value is not None]
    numbers = {
        option: number
        for option in beside
        if option in like.quantities
        and (
            number := quantity(
                _option_name(option), given[option], *(_ASKED | {"rod": _ROD})[option][::2]
            )
        )
        is not None
    }
    is_rocket = kind == "rocket"
    wrong = [one for one in beside if one not in numbers and not (is_rocket and one == "size")]
    size = _length_and_diameter(given["size"]) if is_rocket and given["size"] else None
    curve = None
    if thrust_curve is not None and not like.takes_curve:
        wrong.append("thrust_curve")
    elif thrust_curve is not None:
        if faults := template.curve_faults(thrust_curve):
            raise SceneError(faults)
        curve = {"file": os.path.relpath(thrust_curve.resolve(), file.parent.resolve())}
        if begin := template.clock_time(thrust_curve):
            curve["ignition"] = begin
    from_catalogue.require(like, numbers, wrong)
    text = (
        rocket.text(file.stem, numbers, size, curve)
        if is_rocket
        else deployer.text(file.stem, kind, numbers)
    )
    beside_it = {} if curve else from_catalogue.files(like)
    if errors := rocket.errors(numbers) if is_rocket else deployer.errors(kind, numbers):
        beside_it[from_catalogue.errors_file(file.stem)] = errors
    return text, beside_it


def _require_scene(text: str, file: Path) -> None:
    """Raise SceneError unless ``text`` is a valid scene as the content of ``file``."""
    import tomllib

    from tipoff.scenes.arguments import parse

    raw = tomllib.loads(text)
    if "file" in raw["thrust"]:
        raw["thrust"]["file"] = str(file.parent / raw["thrust"]["file"])
    parse(raw, str(file))


def _require_new(file: Path) -> None:
    """Raise SceneError if the file exists or does not end in .toml."""
    from tipoff.faults import Fault, SceneError
    from tipoff.scenes import names

    faults = []
    if file.suffix != ".toml":
        faults.append(Fault("FILE", "name", str(file), "a name that ends in .toml"))
    if file.exists():
        faults.append(Fault("FILE", "name", str(file), "a file that is not there yet"))
    try:
        names.of_scene(file.stem)
    except ValueError as fault:
        faults.append(Fault("FILE", "name", file.stem, str(fault)))
    if faults:
        raise SceneError(faults)


def _next(found: dict) -> list[str]:
    file = found["file"]
    return [
        f"wrote {file}. Next:",
        f"  tipoff run --scene {file}         # velocity and rates",
        f"  tipoff ensemble --scene {file}    # with random errors of thrust and mass",
        f"  tipoff report --scene {file}      # beside finite elements, on one page",
    ]


def _of_design(
    file: Path, designs: list[Path], others: list, is_rocket: bool
) -> tuple[str, dict[str, str]]:
    """The scene of a design, and of a table of its simulation, and text by name of the files of its thrust and
    its errors. Raises SceneError."""
    from tipoff.faults import Fault, SceneError
    from tipoff.studies.new_scene import from_catalogue, rocket

    given = " ".join(map(str, designs))
    if not is_rocket or any(value is not None for value in others):
        expected = "--rocket and no other option beside a design"
        raise SceneError([Fault("DESIGN.ork", "option", given, expected)])
    if len(designs) > 2:
        expected = "a design, and at most one table of a simulation"
        raise SceneError([Fault("DESIGN.ork", "files", given, expected)])
    found = _design(*designs)
    curve = f"{file.stem}_thrust.csv"
    errors = rocket.errors({"mass": found.mass}, 90.0 - found.rail_angle)
    beside_it = {curve: rocket.csv(found), from_catalogue.errors_file(file.stem): errors}
    return rocket.of_design(file.stem, found, curve), beside_it


def _design(design: Path, table: Path | None = None) -> "Design":
    """The design of a file, and of a table of its simulation. Raises SceneError, the faults of both
    listed."""
    from tipoff.faults import Fault, SceneError
    from tipoff.files import read_input
    from tipoff.formats.designs.openrocket import read_openrocket
    from tipoff.formats.designs.openrocket_table import REFUSED, read_simulation

    simulated, faults = None, []

    def refuse(path: Path, error: Exception) -> None:
        words = f"a readable file ({error.strerror})" if isinstance(error, OSError) else str(error)
        faults.append(Fault(str(path), "design", "this file", words))

    if table is not None:
        try:
            simulated = read_simulation(read_input(table), table.name)
        except (OSError, ValueError) as error:
            refuse(table, error)
            simulated = REFUSED
    try:
        found = read_openrocket(read_input(design), design.name, simulated)
    except (OSError, ValueError) as error:
        refuse(design, error)
    if faults:
        raise SceneError(faults)
    return found


def _length_and_diameter(text: str) -> tuple[float, float]:
    """Length and diameter (m) of a rocket from its size. Raises SceneError."""
    sides = _lengths(text, "1.6 m, 80 mm", "a length and a diameter", (2, 3))
    if sides[1] != sides[-1]:
        raise _no_size(text, "a length and a diameter", "1.6 m, 80 mm")
    return sides[0], sides[1]


def _lengths(text: str, example: str, words: str, counts: tuple[int, ...]) -> list[float]:
    """Lengths (m) above zero, separated by commas. Raises SceneError with an ``example`` of the ``words`` if
    their number is not one of ``counts``."""
    from tipoff.units import to_si

    try:
        sides = [to_si(part.strip(), "m") for part in text.split(",")]
    except ValueError:
        raise _no_size(text, words, example) from None
    if len(sides) not in counts or min(sides) <= 0.0:
        raise _no_size(text, words, example)
    return sides


def _no_size(text: str, words: str, example: str) -> "SceneError":
    from tipoff.faults import Fault, SceneError

    return SceneError([Fault("--size", "value", text, f'{words}, for example "{example}"')])


def _numbers(
    given: dict[str, str | None], thrust_curve: Path | None, pads: int | None, rod: str | None
):
    """The numbers of the new scene in SI. Raises SceneError, every fault listed."""
    from tipoff.faults import together
    from tipoff.studies.new_scene.template import Numbers

    def read(name: str):
        unit, _, default = _ASKED[name]
        text, option = given[name] or default, _option_name(name)
        if name != "size":
            return quantity(option, text, unit, default)
        return tuple(_lengths(text, default, "three lengths", (3,)))

    *found, _, _, _ = together(
        *((lambda name=name: read(name)) for name in _ASKED),
        lambda: _require_curve(thrust_curve, given),
        lambda: _require_pads(pads),
        lambda: _require_rocket(rod),
    )
    numbers = Numbers(*found)._replace(thrust_curve=thrust_curve)
    return numbers if pads is None else numbers._replace(pads=pads)


def _require_curve(file: Path | None, given: dict[str, str | None]) -> None:
    """Raise SceneError for an invalid curve of the thrust, or one beside the options that it
    replaces."""
    from tipoff.faults import Fault, SceneError
    from tipoff.studies.new_scene import template

    if file is None:
        return
    faults = [
        Fault(_option_name(name), "value", given[name] or "", "none beside --thrust-curve")
        for name in ("thrust", "burn_time")
        if given[name] is not None
    ]
    if faults := faults + template.curve_faults(file):
        raise SceneError(faults)


def _require_pads(pads: int | None) -> None:
    """Raise SceneError for a number of pads that does not fit on the rails."""
    from tipoff.faults import SceneError
    from tipoff.studies.new_scene import template

    if pads is not None and (faults := template.pads_faults(pads)):
        raise SceneError(faults)


def _require_rocket(rod: str | None) -> None:
    """Raise SceneError for a rod without a rocket."""
    from tipoff.faults import Fault, SceneError

    if rod is not None:
        raise SceneError([Fault("--rod", "option", rod, "--rocket beside it")])
