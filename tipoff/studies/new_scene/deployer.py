"""A commented scene file of a CubeSat in a deployer, from a few numbers.

It is the scene ``cubesat_3u`` of the catalogue with its comments, and with the given numbers in place of
its own. A given mass is that of a homogeneous box.
"""

from collections.abc import Mapping, Sequence

import tomlkit

from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.scene import CATALOG

DEPLOYERS = {"3u": "cubesat_3u"}  # scene of the catalogue by kind
GIVEN = "given to tipoff new"
# Option, and keys of the scene with the unit and its size in SI.
KEYS = {
    "mass": ("payload.mass", "kg", 1.0),
    "clearance": ("contact.clearance", "mm", 1e-3),
    "thrust": ("thrust.springs.0.preload", "N", 1.0),
}


def text(
    name: str, kind: str, given: Mapping[str, float | None], others: Sequence[str] = ()
) -> str:
    """The scene as TOML for a deployer of a ``kind``, with the ``given`` numbers (SI) by name of the
    option; the others are those of the catalogue. Raises SceneError for names of ``others`` that are
    given, and for a number that is not above zero."""
    own = DEPLOYERS[kind]
    document = tomlkit.parse((CATALOG / f"{own}.toml").read_text(encoding="utf-8"))
    document["name"] = name
    document["description"] = f"Made by tipoff new --deployer {kind}."
    stated = {option: value for option, value in given.items() if value is not None}
    if faults := [*_of_others(others), *_of_numbers(stated)]:
        raise SceneError(faults)
    for option, value in stated.items():
        key, unit, size = KEYS[option]
        _put(document, key, f"{value / size:.6g} {unit}")
        document["provenance"][key] = GIVEN
    if "mass" in stated:
        for axis, moment in _box(stated["mass"], document["payload"]["size"]).items():
            _put(document, f"payload.inertia.{axis}", f"{moment:.6g} kg*m**2")
    return tomlkit.dumps(document).replace(f"--scene {own} ", f"--scene {name}.toml ")


def _of_others(names: Sequence[str]) -> list[Fault]:
    expected = f"none beside --deployer, which takes --{', --'.join(KEYS)}"
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


def _box(mass: float, sides) -> dict[str, float]:
    """Moments of inertia (kg m2) of a homogeneous box with these ``sides``, in text with mm."""
    a, b, c = (1e-3 * float(side.removesuffix(" mm")) for side in sides)
    return {
        "xx": mass * (b**2 + c**2) / 12.0,
        "yy": mass * (a**2 + c**2) / 12.0,
        "zz": mass * (a**2 + b**2) / 12.0,
    }
