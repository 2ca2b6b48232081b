"""A commented scene file that is a scene of the catalogue with its comments, and with the given numbers
in place of its own: a CubeSat in a deployer. A given mass is that of a homogeneous box.
A rocket has a text of its own (``rocket``), and the motor and the errors of the catalogue.

The random errors of the catalogue are about its own numbers, so a scene with other ones gets a file of its
own, with those errors in proportion.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import tomlkit

from tipoff.faults import Fault, SceneError
from tipoff.files import read_input
from tipoff.scenes import overrides
from tipoff.scenes.scene import CATALOG, load
from tipoff.studies.new_scene import deployer
from tipoff.units import to_si

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
    # moments of inertia (kg m2) of a mass (kg), from the table of the payload
    inertia: Callable[[float, Any], dict[str, float]]


def _box(mass: float, payload) -> dict[str, float]:
    """Those of a homogeneous box with the sides of the table, in text with mm."""
    a, b, c = (1e-3 * float(side.removesuffix(" mm")) for side in payload["size"])
    return {
        "xx": mass * (b**2 + c**2) / 12.0,
        "yy": mass * (a**2 + c**2) / 12.0,
        "zz": mass * (a**2 + b**2) / 12.0,
    }


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
            inertia=_box,
        )
        for size in deployer.SIZES
    },
    "rocket": Kind(
        "--rocket",
        "rocket_rail",
        {
            "mass": _MASS,
            "clearance": _CLEARANCE,
            "rail_length": Quantity(("rail.end",), "m", 1.0),
        },
        takes_curve=True,
        inertia=_box,
    ),
}


def require(kind: Kind, given: Mapping[str, float], others: Sequence[str]) -> None:
    """Raise SceneError for names of ``others`` that are given, and for a number that is not above zero."""
    if faults := [*_of_others(kind, others), *_of_numbers(given)]:
        raise SceneError(faults)


def text(name: str, kind: Kind, given: Mapping[str, float]) -> str:
    """The scene as TOML for a ``kind``, with the ``given`` numbers (SI) by name of the option; the others
    are those of the catalogue."""
    document = tomlkit.parse((CATALOG / f"{kind.scene}.toml").read_text(encoding="utf-8"))
    document["name"] = name
    document["description"] = f"Made by tipoff new {kind.option}."
    form = kind.option.rpartition(" ")[2]
    if form != "3u":
        deployer.resize(document, form, given.get("mass"))
        document["description"] = f"A {form.upper()} CubeSat in a deployer with a spring."
    if "mass" in given or form != "3u":
        mass = float(document["payload"]["mass"].removesuffix(" kg"))
        mass = given.get("mass", mass)
        for axis, moment in kind.inertia(mass, document["payload"]).items():
            _put(document, f"payload.inertia.{axis}", f"{moment:.6g} kg*m**2")
    for option, value in given.items():
        keys, unit, size = kind.quantities[option]
        for key in keys:
            _put(document, key, f"{value / size:.6g} {unit}")
        document["provenance"][keys[0]] = GIVEN
    if errors(kind, numbers(kind, given, document)) is not None:
        document["studies"]["errors"] = errors_file(name)
    return tomlkit.dumps(document).replace(f"--scene {kind.scene} ", f"--scene {name}.toml ")


def numbers(kind: Kind, given: Mapping[str, float], document) -> dict[str, float]:
    """The ``given`` numbers, and those of a ``document`` that differ from the scene of its ``kind``."""
    found, scene = {}, load(kind.scene)
    for option, (keys, _, _) in kind.quantities.items():
        part = document
        for name in keys[0].split("."):
            part = part[int(name) if name.isdecimal() else name]
        own = to_si(str(part), overrides.unit(type(scene), keys[0]) or "")
        if option in given or not math.isclose(own, overrides.held(scene, keys[0]), rel_tol=1e-9):
            found[option] = own
    return found


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


def _put(document, key: str, value: str) -> None:
    *path, last = key.split(".")
    for part in path:
        document = document[int(part) if part.isdecimal() else part]
    document[last] = value
