"""Neighbours of a condition: the same launch with the payload and the walls moved by less than 1 um.

    clearance        every wall farther off or nearer by u_0
    position         initial displacement by u_1 along y, u_2 along z
    attitude         initial rotation by u_3 / r_x, u_4 / r_y, u_5 / r_z about the body axes
    u                uniform between -d and d, independent;  d = 1 um
    r_x, r_y, r_z    distance of the farthest pad from that axis

No single draw moves a pad by more than d. These differences are below assembly accuracy, so all
neighbours are the same launch for a user. They are drawn with a fixed seed, and every model runs
the same ones: case n does not depend on the number of cases.
"""

import math
from collections.abc import Sequence

import numpy as np

from tipoff.lowfi.ensemble.derived import Derived, Numbers, law
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty

SEED = 20261123
_AXES = ("x", "y", "z")
_ROOM = 4.0  # times d: with less clearance a neighbour could start inside a wall


def possible(scene: Scene, distance: float) -> bool:
    """Whether ``scene`` has contact, and clearance for neighbours within ``distance`` (m)."""
    return scene.contact is not None and scene.contact.narrowest() >= _ROOM * distance


def draw(scene: Scene, distance: float, cases: int) -> list[dict[str, float]]:
    """Overrides (SI) of ``scene`` for each of ``cases`` neighbours within ``distance`` (m); the
    caller has checked that they are ``possible``."""
    names = ["clearance", "y", "z", *(f"about {axis}" for axis in _AXES)]
    uniform = law("uniform", low=-distance, high=distance)
    drawn = Uncertainty(cases, SEED, "random", dict.fromkeys(names, uniform))
    return Derived(drawn, lambda moved: _overrides(scene, moved)).rows(0, cases)


def levers(scene: Scene) -> tuple[float, float, float]:
    """Distance (m) of the farthest pad from the x, y and z axis through the nominal mass centre."""
    places = np.array([pad.position for pad in scene.pads])
    squares = places**2
    x, y, z = (math.sqrt(float(np.delete(squares, axis, 1).sum(1).max())) for axis in range(3))
    return x, y, z


def _overrides(scene: Scene, moved: Numbers) -> Numbers:
    """Columns of overrides for columns (n,) of the draws (m)."""
    assert scene.contact is not None  # or no neighbours are possible
    position, attitude = _initial(scene)
    shifts = {
        f"initial.position.{axis}": position[place] + moved[axis]
        for place, axis in enumerate(_AXES)
        if axis in moved
    }
    turns = {
        f"initial.attitude.{axis}": attitude[place] + moved[f"about {axis}"] / lever
        for place, (axis, lever) in enumerate(zip(_AXES, levers(scene)))
    }
    return scene.contact.widened(moved["clearance"]) | shifts | turns


def _initial(scene: Scene) -> tuple[Sequence[float], Sequence[float]]:
    """Position (m) and attitude (rad) that the scene states at ignition."""
    if scene.initial is None:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    record = scene.initial.record()
    return record.position, record.attitude
