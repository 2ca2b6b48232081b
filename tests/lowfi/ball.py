"""A ball without spin that strikes a plane obliquely, on springs."""

import math

from tests.lowfi.support import numerics, scene
from tipoff import lowfi
from tipoff.results.trajectory import Trajectory


def mass(radius: float, density: float) -> float:
    """Mass (kg) of a solid ball."""
    return density * 4.0 / 3.0 * math.pi * radius**3


def strike(
    radius: float,
    weight: float,
    velocity: tuple[float, float],
    contact: dict,
    friction: dict,
    duration: float,
    tolerance: float,
) -> Trajectory:
    """The run of a solid ball of ``radius`` (m) and mass ``weight`` (kg) that has the ``velocity``
    (m/s) along the plane, +x, and towards it, -z; ``duration`` (s) is that of approach and contact.
    The plane is the wall of one pad at the lowest point of the ball."""
    along, closing = velocity
    inertia = 0.4 * weight * radius**2
    run = lowfi.run(
        scene(
            duration,
            duration / 100,
            mass=weight,
            inertia={"xx": inertia, "yy": inertia, "zz": inertia},
            pads=[{"position": (0.0, 0.0, -radius), "normals": ["-z"]}],
            contact=contact,
            friction=friction,
            initial={"velocity": {"x": along, "z": -closing}},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    assert run.status == "time_limit", run.message
    return run
