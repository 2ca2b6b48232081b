"""X8 in an interpreter of its own: 1 kg on four feet, dragged over a rough plane through a spring
whose far end moves at 0.1 mm/s.

No scene holds a spring to something that moves, so one external force is added to the thrust before
any kernel is compiled; all the rest, ``lowfi.run`` with its steps, events, stick-slip, limits and
ledgers, is the code under test. Called with the path of a thrust file that is next to nothing, it
prints what it found as JSON.
"""

import json
import sys

import numpy as np

from tests.lowfi.support import G, numerics, scene
from tipoff import lowfi
from tipoff.kernels.jit import inlined
from tipoff.lowfi import state as slot
from tipoff.lowfi.dynamics import equations
from tipoff.mechanics import ledger

STIFFNESS, SPEED = 1e4, 1e-4  # of the drag spring (N/m) and of its far end (m/s)
STATIC, DYNAMIC = 0.4, 0.3
STRETCHED = 0.2 * G / STIFFNESS  # m, at the begin: half of what the feet bear
FEET = [{"position": (x, y, 0.0), "normals": ["-z"]} for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
GROUND = {"law": "linear", "clearance": 0.0, "stiffness": 1e6, "damping": 500.0}
STICKING = {
    "law": "sticking",
    "static": STATIC,
    "dynamic": DYNAMIC,
    "stiffness": 1e6,
    "damping": 500.0,
}
TWO_STEP = {"static": STATIC, "dynamic": DYNAMIC, "static_speed": 1e-3, "dynamic_speed": 2e-3}
_thrust = equations.add_thrust


@inlined
def _thrust_and_drag(thrust, offset, reacts, time, bodies, out):
    _thrust(thrust, offset, reacts, time, bodies, out)
    body = bodies.payload
    force = (STIFFNESS * (STRETCHED + SPEED * time - body.place[0]), 0.0, 0.0)
    equations.push(out, slot.PAYLOAD, force, body.place, 1.0)
    equations.add_outside_impulse(force, body.place, out)
    equations.add_power(
        slot.THRUST,
        slot.THRUST_AXIAL,
        force,
        body.velocity,
        body.velocity[0],
        1.0,
        out,
    )


def drag(friction: dict, tolerance: float, idle: str) -> dict:
    """Slips begin (s), their lengths (m), counts and promises of 6.2 s of dragging."""
    run = lowfi.run(
        scene(
            6.2,
            1e-3,
            mass=1.0,
            pads=FEET,
            contact=GROUND,
            friction=friction,
            gravity={"z": -G},
            initial={"position": {"z": -0.25 * G / GROUND["stiffness"]}},
            thrust={"kind": "measured", "file": idle},
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    place, slipping = run.position[:, 0], run.velocity[:, 0] > 5.0 * SPEED
    begins, ends = (
        np.flatnonzero(slipping[1:] & ~slipping[:-1]),
        np.flatnonzero(~slipping[1:] & slipping[:-1]) + 1,
    )
    rubbed = run.energy[:, ledger.ENTRIES.index("friction")]
    return {
        "status": run.status,
        "slips": run.time[begins].tolist(),
        "lengths": (place[ends] - place[begins]).tolist(),
        "least_rubbed": float(np.diff(rubbed).min()),
        "events": run.cost["events"],
        "checks": run.checks,
    }


if __name__ == "__main__":
    equations.add_thrust = _thrust_and_drag
    found = {
        f"sticking {tolerance:g}": drag(STICKING, tolerance, sys.argv[1])
        for tolerance in (1e-6, 1e-8)
    }
    print(json.dumps(found | {"two-step": drag(TWO_STEP, 1e-6, sys.argv[1])}))
