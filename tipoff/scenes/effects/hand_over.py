"""How the rail stands on the ground, for flight codes that take the state at exit.

Inertial axes are East, North and up. The launch axis X has the components::

    X = (sin h cos i, cos h cos i, sin i)      i: inclination, h: heading

Gravity in scene axes gives the inclination and the roll about X. Without it, +Z is the upper side
of the rail. The ejection does not depend on this table.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field

from tipoff.faults import Fault, SceneError
from tipoff.scenes.parts import body
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import Angle, Inclination, Length

_SAME = np.radians(0.1)  # largest difference between an inclination and that of gravity


class HandOverTable(Table):
    """``[hand_over]``: the rail on the ground, and the place of the dry mass centre."""

    #: Angle of the launch axis above the horizontal plane; that of gravity where absent, else 90
    #: deg.
    inclination: Inclination | None = None
    #: Angle of the launch axis from North towards East; 0 (assumed) where absent.
    heading: Angle | None = None
    #: Height of the payload's mass centre at ignition above sea level; 0 (assumed) where absent.
    elevation: Length | None = None
    #: Distance of the mass centre without propellant ahead of the mass centre; 0 (assumed) where
    #: absent.
    dry_mass_centre: Length | None = None
    #: Place of the rail buttons about the rocket, as RocketPy's angular_position; 180 deg where
    #: absent: RocketPy's body axes x and y are then y and z.
    angular_position: Angle | None = Field(None, exclude_if=is_absent)


class Standing(NamedTuple):
    """The rail on the ground."""

    axes: np.ndarray  # (3,3) components East, North and up of scene vectors
    inclination: float  # rad
    heading: float  # rad
    elevation: float  # m
    dry_mass_centre: float  # m, ahead of the mass centre
    body: np.ndarray  # (3,3) components in our body axes of RocketPy's ones, as columns
    assumed: tuple[str, ...]  # values that the scene does not state, in words


def standing(scene: Mapping[str, Any]) -> Standing:
    """The rail of a resolved scene (``Scene.resolved``).

    Raises SceneError for an inclination that differs from that of gravity.
    """
    table = {key: value for key, value in scene.get("hand_over", {}).items() if value is not None}
    stated = scene.get("gravity", {})
    gravity = np.array([stated.get(axis, 0.0) for axis in "xyz"])
    if (angle := stated.get("inclination")) is not None:
        gravity += body.gravity(scene, angle)
    size, assumed = float(np.linalg.norm(gravity)), []
    up = -gravity / size if size > 0.0 else None
    inclination = table.get("inclination")
    if up is not None:
        by_gravity = float(np.arctan2(up[0], np.hypot(up[1], up[2]))) + 0.0  # never -0
        if inclination is None:
            inclination = by_gravity
        elif abs(inclination - by_gravity) > _SAME:
            given = f"{np.degrees(inclination):.6g} deg"
            expected = f"{np.degrees(by_gravity):.6g} deg, which [gravity] states, or no such key"
            raise SceneError([Fault(scene["name"], "hand_over.inclination", given, expected)])
    if inclination is None:
        inclination = 0.5 * np.pi
        assumed.append("inclination 90 deg")
    across = np.array([0.0, 0.0, 1.0])
    if up is not None and np.hypot(up[1], up[2]) > _SAME:
        across = np.array([0.0, up[1], up[2]]) / np.hypot(up[1], up[2])
    else:
        assumed.append("+Z is the upper side of the rail")
    values = {}
    for name, words in (
        ("heading", "heading 0 deg (North)"),
        ("elevation", "elevation 0 m"),
        ("dry_mass_centre", "dry mass centre at the mass centre"),
    ):
        values[name] = table.get(name, 0.0)
        if name not in table:
            assumed.append(words)
    return Standing(
        axes=_axes(inclination, values["heading"], across),
        inclination=float(inclination),
        body=body_axes(table.get("angular_position")),
        assumed=tuple(assumed),
        **values,
    )


def body_axes(angular_position: float | None) -> np.ndarray:
    """(3,3) components in our body axes of RocketPy's ones, as columns, for buttons at this angle (rad),
    180 deg without one: at ignition RocketPy turns the rocket so that (sin, cos, 0) points to the rail."""
    cosine, sine = -1.0, 0.0
    if angular_position is not None:
        cosine, sine = float(np.cos(angular_position)), float(np.sin(angular_position))
    return np.array([[0.0, 0.0, 1.0], [-cosine, sine, 0.0], [-sine, -cosine, 0.0]])


def _axes(inclination: float, heading: float, across: np.ndarray) -> np.ndarray:
    """Components East, North and up of scene vectors; ``across`` (3,) is the unit vector across the
    rail, in scene axes, that points up as far as it can."""
    (ci, ch), (si, sh) = np.cos([inclination, heading]), np.sin([inclination, heading])
    along, upper = np.array([sh * ci, ch * ci, si]), np.array([-sh * si, -ch * si, ci])
    x = np.array([1.0, 0.0, 0.0])
    return (
        np.outer(along, x)
        + np.outer(upper, across)
        + np.outer(np.cross(along, upper), np.cross(x, across))
    )
