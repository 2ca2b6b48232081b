"""A rigid block slides along an elastic bar and strikes it: the case of ``quadratic``, solved by the
reference on a mesh of its own.

The bar lies along X between two clamped ends. Its upper side is in the plane z = -HEIGHT below the
block's mass centre. The block has one crowned pad below it. The pad presses with the interface stiffness
and always slips.
"""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from tipoff import highfi
from tipoff.highfi.mesh.rail_mesh import boundary_facets
from tipoff.meshes import bricks, msh
from tipoff.scenes import parse
from validation.peers.case import require_ours

LENGTH, WIDTH, DEPTH = 0.072, 0.024, 0.012  # m, the bar along x, y and z
DENSITY, MODULUS, RATIO = 2810.0, 72e9, 0.33
MASS, INERTIA = 0.1, 1e-4  # kg, kg m2 about each axis
HEIGHT = 0.02  # m, mass centre above the face of the pad
PAD, RELIEF = 0.016, 20e-6  # m, side of the pad and depth of its crown at an edge
START = -12e-3  # m, of the block along x from the middle of the bar
GAP = 2e-6  # m
SPEED, APPROACH = 5.0, 0.1  # m/s along x and towards the bar
FRICTION = 0.2
STIFFNESS = 1.8e12  # N/m3, times a factor
DURATION = 0.4e-3  # s
_INTERVAL = 5e-6  # s
UNITS = {
    "rebound": "m/s",
    "pitch rate": "rad/s",
    "normal impulse": "N s",
    "friction impulse": "N s",
}


def inputs() -> dict:
    """All numbers of the case, SI."""
    return {
        "bar": [LENGTH, WIDTH, DEPTH],
        "material": [DENSITY, MODULUS, RATIO],
        "mass": MASS,
        "inertia": INERTIA,
        "height": HEIGHT,
        "pad": [PAD, RELIEF],
        "start": START,
        "gap": GAP,
        "velocity": [SPEED, -APPROACH],
        "friction": FRICTION,
        "interface_stiffness": STIFFNESS,
        "duration": DURATION,
    }


def solve(size: float, factor: float) -> dict[str, float]:
    """The reference in elements of ``size`` (m) with ``factor`` times the interface stiffness: speed
    away from the bar (m/s), pitch rate (rad/s), impulses along z and x (N s)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "bar.msh")
        msh.save(bar(size), path)
        found = highfi.run(_scene(path, factor), highfi.Numerics(element_size=size))
    require_ours(found, "time_limit", DURATION)
    velocity, rate = found.velocity[-1], found.rate[-1]
    return {
        "rebound": float(velocity[2]),
        "pitch rate": float(rate[1]),
        "normal impulse": MASS * float(velocity[2] + APPROACH),
        "friction impulse": MASS * float(velocity[0] - SPEED),
        "cpu_s": float(found.cost["cpu_s"]),
    }


def bar(size: float) -> meshio.Mesh:
    """The bar in elements of ``size`` (m), with its upper side and its clamped ends."""
    lines = [
        np.linspace(low, high, round((high - low) / size) + 1)
        for low, high in (
            (-0.5 * LENGTH, 0.5 * LENGTH),
            (-0.5 * WIDTH, 0.5 * WIDTH),
            (-HEIGHT - GAP - DEPTH, -HEIGHT - GAP),
        )
    ]
    metal = np.ones([len(line) - 1 for line in lines], dtype=bool)
    points, cells = bricks.filled(lines, metal)
    facets = boundary_facets(cells)
    corner = points[facets]
    upper = (corner[..., 2] == lines[2][-1]).all(axis=1)
    held = (np.abs(corner[..., 0]) == 0.5 * LENGTH).all(axis=1)
    return msh.tagged(points, cells, {"contact_z": facets[upper], "mount": facets[held]})


def _scene(path: Path, factor: float):
    return parse(
        {
            "name": "sliding-impact",
            "duration": DURATION,
            "output": {"interval": _INTERVAL},
            "payload": {"mass": MASS, "inertia": {"xx": INERTIA, "yy": INERTIA, "zz": INERTIA}},
            "pads": [
                {
                    "position": [0.0, 0.0, -HEIGHT],
                    "normals": ["-z"],
                    "length": PAD,
                    "width": PAD,
                    "relief": RELIEF,
                }
            ],
            "rail": {
                "mesh": str(path),
                "start": -0.5 * LENGTH,
                "end": 0.5 * LENGTH,
                "clearance": GAP,
                "material": {
                    "density": DENSITY,
                    "youngs_modulus": MODULUS,
                    "poisson_ratio": RATIO,
                },
            },
            "thrust": {"kind": "constant", "force": 0.0, "duration": DURATION},
            "contact": {
                "law": "linear",
                "clearance": GAP,
                "stiffness": 1.0,
                "interface_stiffness": factor * STIFFNESS,
            },
            "friction": {
                "static": FRICTION,
                "dynamic": FRICTION,
                "static_speed": 0.01,
                "dynamic_speed": 0.02,
            },
            "initial": {
                "position": {"x": START},
                "velocity": {"x": SPEED, "z": -APPROACH},
            },
        },
        bare_numbers_are_si=True,
    )
