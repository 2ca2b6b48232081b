"""Parameters for errors of mounting: initial position and attitude within the clearance, direction
and line of the thrust, mass centre, products of inertia.

They are changes (``scenes.changes``): one value for all conditions, added to the values of each
condition. An error that differs from condition to condition cannot be fitted. An absent table
counts as zero and is added.

Rates show only the moment of the thrust F about the mass centre (small tilts theta, line of thrust
e, mass centre c, arm a)::

    M_y = F (e_z - c_z + a theta_z)        M_z = -F (e_y - c_y + a theta_y)

Before pads touch, three parameters of an axis have the same effect. Contact depends on the mass
centre and on the lateral force, so later curves may separate them.
"""

import math

import numpy as np

from tipoff.calibration.parameters import Parameter
from tipoff.scenes import scene_model
from tipoff.scenes.body import tensor
from tipoff.scenes.scene import Scene

_TILT = math.radians(1.0)
_OFFSET = 2e-3  # m
_ARM = 0.1
_MOMENT = 0.1
NAMES = (
    *(f"initial.position.{axis}" for axis in "yz"),
    *(f"initial.attitude.{axis}" for axis in "xyz"),
    *(f"thrust_offset.misalignment.{axis}" for axis in "yz"),
    *(f"thrust_offset.eccentricity.{axis}" for axis in "yz"),
    "thrust.arm",
    *(f"mass_offset.eccentricity.{axis}" for axis in "yz"),
    *(f"payload.inertia.{axes}" for axes in ("xy", "xz", "yz")),
)


def free(scene: Scene) -> list[Parameter]:
    """The changes that a fit of ``scene`` may find. Without clearance, the initial state cannot
    change."""
    return [*_initial(scene), *_thrust(scene), *_mass_centre(), *_inertia(scene)]


def changes(values: dict[str, float]) -> dict[str, float]:
    """The changes among the ``values`` of parameters by name."""
    return {name: value for name, value in values.items() if name in NAMES}


def _change(name: str, unit: str, bound: float, justification: str) -> Parameter:
    return Parameter(
        name=name,
        unit=unit,
        lower=-bound,
        upper=bound,
        logarithmic=False,
        justification=f"a change, the same in every condition; {justification}",
        read=lambda _: 0.0,
    )


def _initial(scene: Scene) -> list[Parameter]:
    if scene.contact is None:
        return []
    faces, gaps = scene_model.built(scene).nominal, np.array(scene.contact.gaps())
    found = [
        _change(
            f"initial.position.{name}",
            "m",
            float(gaps[axis]),
            "up to the clearance either way, where the pads of a centred payload touch",
        )
        for axis, name in ((1, "y"), (2, "z"))
        if gaps[axis] > 0.0
    ]
    for axis, name in enumerate("xyz"):
        # of each face along its normal, per radian
        moved = np.abs(
            np.cross(np.eye(3)[axis], faces.centre)[np.arange(faces.axis.size), faces.axis]
        )
        room = gaps[faces.axis][moved > 0.0] / moved[moved > 0.0]
        if room.size and room.min() > 0.0:
            reason = (
                "up to the angle at which the middle of a pad face of a centred payload touches"
            )
            found.append(_change(f"initial.attitude.{name}", "rad", float(room.min()), reason))
    return found


def _thrust(scene: Scene) -> list[Parameter]:
    return [
        *(
            _change(
                f"thrust_offset.misalignment.{axis}",
                "rad",
                _TILT,
                "1 deg is more than twice three standard deviations of the paper (0.4 deg)",
            )
            for axis in "yz"
        ),
        *(
            _change(
                f"thrust_offset.eccentricity.{axis}",
                "m",
                _OFFSET,
                "2 mm is three times three standard deviations of the paper (0.6 mm)",
            )
            for axis in "yz"
        ),
        _change(
            "thrust.arm",
            "m",
            _ARM * scene.thrust.arm,
            "a tenth of the arm: both ends of it are on drawings, and the charge burns between",
        ),
    ]


def _mass_centre() -> list[Parameter]:
    return [
        _change(
            f"mass_offset.eccentricity.{axis}",
            "m",
            _OFFSET,
            "2 mm is the error of a mass budget; a balanced payload is within a tenth of that",
        )
        for axis in "yz"
    ]


def _inertia(scene: Scene) -> list[Parameter]:
    moments = np.linalg.eigvalsh(tensor(scene.payload.inertia))
    # Three changes b move the principal moments by at most 2 b, and the triangle inequality allows
    # half of its remaining margin.
    spare = 0.5 * (moments[0] + moments[1] - moments[2])
    bound = float(min(_MOMENT * moments[0], 0.49 * spare))
    return [
        _change(
            f"payload.inertia.{axes}",
            "kg*m**2",
            bound,
            "a tenth of the smallest principal moment, less where the tensor would not be one of a "
            "body",
        )
        for axes in ("xy", "xz", "yz")
        if bound > 0.0
    ]
