"""What a new scene takes from one of the catalogue: the quantities that options of the command give, its files,
and its random errors. These are about its own numbers, so a scene with other ones gets a file of its own,
with those errors in proportion.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import tomlkit

from tipoff.faults import Fault, SceneError
from tipoff.files import read_input, write_text
from tipoff.scenes import overrides
from tipoff.scenes.parts.deployer import CUBESATS
from tipoff.scenes.scene import CATALOG, load

GIVEN = "given to tipoff new"
_LEVELS = {"mean", "sd", "low", "high", "value"}  # of a distribution, with a unit


class Quantity(NamedTuple):
    """What an option changes."""

    keys: tuple[str, ...]  # of the scene
    unit: str
    size: float  # of the unit in SI


class Kind(NamedTuple):
    """A kind of scene."""

    option: str  # of the command
    scene: str  # of the catalogue
    quantities: dict[str, Quantity]  # by name of the option
    takes_curve: bool  # whether --thrust-curve replaces the thrust


_MASS = Quantity(("payload.mass",), "kg", 1.0)
_CLEARANCE = Quantity(("contact.clearance",), "mm", 1e-3)
KINDS = {
    **{
        size: Kind(
            f"--deployer {size}",
            "cubesat_3u",
            {
                "mass": _MASS,
                "clearance": _CLEARANCE,
                "thrust": Quantity(("thrust.springs.0.preload",), "N", 1.0),
            },
            takes_curve=False,
        )
        for size in CUBESATS
    },
    "rocket": Kind(
        "--rocket",
        "rocket_rail",
        {
            "mass": _MASS,
            "clearance": _CLEARANCE,
            "rail_length": Quantity(("rail.end",), "m", 1.0),
            "rod": Quantity(("rail.section.diameter",), "mm", 1e-3),
        },
        takes_curve=True,
    ),
}


def require(kind: Kind, given: Mapping[str, float], others: Sequence[str]) -> None:
    """Raise SceneError for names of ``others`` that are given, and for a number that is not above zero."""
    if faults := [*_of_others(kind, others), *_of_numbers(given)]:
        raise SceneError(faults)


def errors_file(name: str) -> str:
    """Name of the file of errors beside the scene of this ``name``."""
    return f"{name}_errors.toml"


def errors(kind: Kind, given: Mapping[str, float]) -> str | None:
    """The random errors of the catalogue with those about ``given`` numbers (SI) in proportion to them;
    None if none is about one of these."""
    scene = load(kind.scene)
    assert scene.studies and scene.studies.errors
    path = CATALOG / "vary" / f"{scene.studies.errors}.toml"
    document = tomlkit.parse(path.read_text(encoding="utf-8"))
    changed = False
    for option, value in given.items():
        key = kind.quantities[option].keys[0]
        if key in document["vary"]:
            table, share = document["vary"][key], value / float(overrides.held(scene, key))
            for name in _LEVELS & set(table):
                number, unit = table[name].split(" ", 1)
                table[name] = f"{share * float(number):.6g} {unit}"
            table["provenance"] = f"in proportion to the number {GIVEN}"
            changed = True
    return tomlkit.dumps(document) if changed else None


def files(kind: Kind) -> dict[str, str]:
    """Texts of the files of the catalogue that the scene of a ``kind`` names, by their names."""
    document = tomlkit.parse((CATALOG / f"{kind.scene}.toml").read_text(encoding="utf-8"))
    named = document["thrust"].get("file")
    return {named: read_input(CATALOG / Path(named)).decode("utf-8")} if named else {}


@contextmanager
def written(folder: Path, texts: Mapping[str, str]) -> Iterator[None]:
    """Text by name as files of a folder. They are removed again if what follows fails. Raises SceneError if
    one is there with another text: it may be of another scene, or changed by hand."""
    made, faults = [], []
    for name, text in texts.items():
        if not (folder / name).exists():
            made.append(name)
        elif read_input(folder / name) != text.encode():
            expected = "a file that is not there yet: the new scene has one with this name"
            faults.append(Fault(name, "file", str(folder / name), expected))
    if faults:
        raise SceneError(faults)
    try:
        for name in made:
            write_text(folder / name, texts[name])
        yield
    except BaseException:
        for name in made:
            (folder / name).unlink(missing_ok=True)
        raise


def _of_others(kind: Kind, names: Sequence[str]) -> list[Fault]:
    taken = [*kind.quantities, *(["thrust-curve"] if kind.takes_curve else [])]
    expected = f"none beside {kind.option}, which takes --{', --'.join(taken)}"
    return [Fault(f"--{name.replace('_', '-')}", "option", "a value", expected) for name in names]


def _of_numbers(stated: Mapping[str, float]) -> list[Fault]:
    return [
        Fault(f"--{option}", "value", f"{value:g}", "above zero")
        for option, value in stated.items()
        if not value > 0.0
    ]
