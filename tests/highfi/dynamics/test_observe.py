"""Samples of a run, against plain sums over all bodies and nodes."""

import numpy as np
import pytest

from tests.highfi.support import begun, tiny
from tipoff.highfi.dynamics import observe
from tipoff.highfi.simulation import Loop
from tipoff.highfi.statics.assembly import sparse
from tipoff.kernels import rotation

EARLY = {
    "initial": {
        "position": {"y": 1e-3, "z": 1e-3},
        "velocity": {"y": 0.1, "z": -0.05},
        "rate": {"x": 0.1, "y": -0.2, "z": 0.3},
    },
    "contact__clearance": "1 mm",
}
DAMPED = {"rail__damping": {"frequencies": ["500 Hz", "5 kHz"], "ratios": [0.05, 0.01]}}
PLATFORM_RATE = {"x": 0.2, "y": 0.1, "z": -0.3}


def size(vectors: np.ndarray) -> np.ndarray:
    """Lengths of vectors (...,3)."""
    return np.linalg.norm(vectors, axis=-1)


def stiffness_energy(loop: Loop) -> float:
    """u'K u / 2 (J) with the assembled matrix."""
    system = loop.setup.system
    u = loop.stepper.state.displacement[system.number].ravel()
    return 0.5 * float(u @ (sparse(system.operator) @ u))


def plain(loop: Loop) -> dict[int, np.ndarray]:
    """Parts of the sample by their first slot, from the velocities before and after a kick."""
    stepper = loop.stepper
    system, state = stepper.now, stepper.state
    before, after = stepper.moving()
    middle = observe.Moving(*(0.5 * (a + b) for a, b in zip(before, after)))
    # nodes half a step before and after, by a kick of everything
    saved = state.velocity.copy(order="K"), observe.moving(state)
    stepper.kick(stepper.step)
    first, second = saved[0][system.nodes], state.velocity[system.nodes].copy()
    state.velocity[:] = saved[0]
    observe.restore(state, saved[1])
    turn, base = (
        rotation.matrices(body.quaternion[None])[0] for body in (state.payload, state.platform)
    )
    payload, frame, origin = system.model.payload, system.frame, state.platform.position
    if frame is not None:
        origin = origin - base @ frame.centre
    mass = system.moving_mass[system.nodes]
    places = (system.rail.points + state.displacement)[system.nodes] @ base.T + origin
    bodies = [
        (places, mass[:, None] * 0.5 * (first + second) @ base.T, np.zeros(3)),
        (state.payload.position[None], payload.mass * middle.velocity[None], middle.spin),
    ]
    kinetic = payload.mass * before.velocity @ after.velocity
    kinetic += (mass * (first * second).sum(axis=1)).sum()
    kinetic += before.spin @ turn @ payload.inverse_inertia @ turn.T @ after.spin
    axial = payload.mass * before.velocity[0] * after.velocity[0]
    if frame is not None:
        carried = frame.mass * middle.platform_velocity
        bodies.append((state.platform.position[None], carried[None], middle.platform_spin))
        kinetic += frame.mass * before.platform_velocity @ after.platform_velocity
        kinetic += (
            before.platform_spin @ base @ frame.inverse_inertia @ base.T @ after.platform_spin
        )
        ends = [
            frame.mass * part.platform_velocity[0] + (mass @ nodes @ base.T)[0]
            for part, nodes in ((before, first), (after, second))
        ]
        axial += ends[0] * ends[1] / frame.total_mass
    orbits = [np.cross(place, momentum) for place, momentum, _ in bodies]
    spins = [spin for _, _, spin in bodies]
    return {
        observe.VELOCITY: middle.velocity,
        observe.RATE: payload.inverse_inertia @ turn.T @ middle.spin,
        observe.KINETIC: np.array([0.5 * kinetic]),
        observe.AXIAL_KINETIC: np.array([0.5 * axial]),
        observe.STRAIN: np.array([stiffness_energy(loop)]),
        observe.LINEAR: sum(momentum.sum(axis=0) for _, momentum, _ in bodies),
        observe.ANGULAR: sum(o.sum(axis=0) for o in orbits) + sum(spins),
        observe.IMPULSE: middle.impulse,
        observe.SIZES: np.array(
            [
                sum(size(momentum).sum() for _, momentum, _ in bodies),
                sum(size(o).sum() for o in orbits) + sum(size(spin) for spin in spins),
                sum((size(r) * size(p)).sum() for r, p, _ in bodies)
                + sum(size(spin) for spin in spins),
            ]
        ),
    }


@pytest.mark.parametrize(
    "changes", [{}, {"platform": None}, DAMPED], ids=["free", "fixed", "damped"]
)
def test_a_sample_has_the_sums_over_all_bodies_and_nodes(changes):
    """After some steps with pressed pads. Control: the strain energy of the whole resistance, contact
    included, differs."""
    early = {**EARLY, "initial": EARLY["initial"] | {"platform_rate": PLATFORM_RATE}}
    loop = begun(tiny(**(EARLY if changes.get("platform", True) is None else early), **changes))
    loop.advance_steps(20)
    state = loop.stepper.state
    assert state.load[0]["pressed"] > 0
    expected, velocity = plain(loop), state.velocity.copy()
    row = loop.stepper.sample()
    assert np.array_equal(state.velocity, velocity)  # a sample changes nothing
    for first, values in expected.items():
        found = row[first : first + len(values)]
        scale = np.abs(values).max()
        assert np.abs(found - values).max() <= 1e-12 * scale, first
    # Control:
    whole = 0.5 * float((state.displacement * state.resistance).sum())
    assert abs(whole - row[observe.STRAIN]) > 1e-3 * row[observe.STRAIN]
