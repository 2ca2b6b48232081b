"""A scene of a CubeSat in its deployer from a few numbers; size, pads and rails follow from its form.

The spring gives the speed of the scene ``cubesat_3u``: with the mass m and the stroke s, its force is in
proportion to m / s, and its rate to its force over s.
"""

import math
from collections.abc import Mapping

import tomlkit

from tipoff.scenes.parts.deployer import CUBESATS
from tipoff.scenes.reading import FORMAT
from tipoff.studies.new_scene import from_catalogue

_MASS, _STROKE, _FORCE, _RATE = 4.0, 330.0, 20.0, 0.04  # kg, mm, N, N/mm: of the scene cubesat_3u
_TEXT = """\
# A CubeSat in a deployer with a spring. provenance says what is given and assumed: replace what you know.
# "tipoff scenes --show {name}.toml" writes out size, inertia, pads, rails, stroke and all else that follows.
# How probable is a rate above 10 deg/s?
#   tipoff ensemble --scene {name}.toml --limit "x=10 deg/s" --limit "y=10 deg/s" --limit "z=10 deg/s"
format = {format}
name = {named}
deployer = {{ cubesat = "{form}" }}
payload = {{ mass = "{mass:.6g} kg" }}
contact = {{ clearance = "{clearance:.6g} mm" }}  # play of each pad
friction = {{ static = 0.2, dynamic = 0.2 }}
output = {{ interval = "0.5 ms" }}
studies = {{ errors = {errors}, element_size = "8 mm", neighbours = 5, highfi_repeats = 1 }}
[thrust]
kind = "springs"
[[thrust.springs]]
preload = "{force:.6g} N"
rate = "{rate:.6g} N/mm"
friction = "0.5 N"
mass = "0.15 kg"  # the pusher plate and half of the spring
[mass_offset.eccentricity]
axial = "5 mm"  # the specification allows 20 mm along Y and along Z
radial = "35 deg"
[platform]  # an upper stage
mass = "1500 kg"
mass_centre = {{ x = "-1 m" }}
inertia = {{ xx = "1000 kg*m**2", yy = "3000 kg*m**2", zz = "3000 kg*m**2" }}
[provenance]
{sources}
"""


def text(name: str, form: str, given: Mapping[str, float]) -> str:
    """The scene as TOML of a ``form`` with the ``given`` numbers (SI) by name of the option."""
    force, rate = _spring(form, given)
    file = "cubesat_3u" if errors(form, given) is None else from_catalogue.errors_file(name)
    return _TEXT.format(
        name=name,
        format=FORMAT,
        named=tomlkit.item(name).as_string(),
        form=form,
        mass=_mass(form, given),
        clearance=1e3 * given.get("clearance", 0.2e-3),
        errors=tomlkit.item(file).as_string(),
        force=force,
        rate=rate,
        sources="\n".join(f'"{key}" = "{own}"' for key, own in _sources(form, given).items()),
    )


def errors(form: str, given: Mapping[str, float]) -> str | None:
    """The random errors of the scene ``cubesat_3u`` about the spring and the ``given`` numbers (SI); None if these
    are its own."""
    force, _ = _spring(form, given)
    moved = {} if math.isclose(force, _FORCE) else {"thrust": force}
    return from_catalogue.errors(from_catalogue.KINDS[form], {**given, **moved})


def _mass(form: str, given: Mapping[str, float]) -> float:
    """The given mass (kg), or two thirds of the largest, as on the scene ``cubesat_3u``."""
    return given.get("mass", 2.0 / 3.0 * CUBESATS[form].most)


def _spring(form: str, given: Mapping[str, float]) -> tuple[float, float]:
    """Force (N) at zero travel and rate (N/mm) of the spring."""
    shorter = _STROKE / CUBESATS[form].stroke
    force = given.get("thrust", _FORCE * _mass(form, given) / _MASS * shorter)
    return force, _RATE * force / _FORCE * shorter


def _sources(form: str, given: Mapping[str, float]) -> dict[str, str]:
    own = CUBESATS[form]
    found = {
        "payload.mass": f"assumed: two thirds of {own.most:g} kg; {own.source}: up to {own.most:g} kg",
        "contact.clearance": "assumed; J-SSOD: 100 +- 0.1 mm across the rails of a CubeSat",
        "friction": "assumed: hard anodised aluminium on the same",
        "thrust": "assumed"
        if "thrust" in given
        else "assumed: exit at 1.4 m/s, within the 1 to 2 m/s that are usual for deployers",
        "mass_offset": "assumed",
        "platform": "assumed: an upper stage",
    }
    quantities = from_catalogue.KINDS[form].quantities
    return found | {quantities[option].keys[0]: from_catalogue.GIVEN for option in given}
