"""The payload at rest on its rails: pose and deflection before the run.

Bodies and rails fall onto each other without thrust and friction. All velocities are set to zero
whenever the kinetic energy has passed a peak (kinetic damping: Cundall 1976; Papadrakakis, Comput.
Methods Appl. Mech. Eng. 36 (1983) 217). At a peak the forces nearly balance, so the energy of the
peaks tends to zero. The travel is held.

Where nothing holds a payload, such as along Y under a weight along Z, the tilt of its pads leaves a small
force, with which it would slide for seconds to the next wall. It stays in its place: friction holds it
there, or it slides from ignition on.
"""

from dataclasses import replace

import numpy as np

from tipoff.highfi.dynamics.setup import Setup
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.kernels import rotation
from tipoff.mechanics.laws.thrust import Thrust
from tipoff.mechanics.lowered import lowered
from tipoff.scenes.settled import no_rest

# Energy of a peak over that of the first one in contact: forces then differ from the weight by the root
# of it, relative.
AT_REST = 1e-12
_SLIDING = 20_000  # steps in which the energy only grows
_SLOW = 1e-3  # acceleration over that of the weight, of a payload that slides
_STEPS = 20  # between two looks at the kinetic energy
_MOST = 5_000_000  # steps


def settle(stepper: Stepper) -> int:
    """Put payload and rails of ``stepper``, which has not begun, to rest. Returns the number of steps
    that this took. Raises SceneError if they do not come to rest."""
    setup = stepper.setup
    resting = Stepper(_alone(setup))
    body, weight = resting.state.payload, setup.system.model.body_force
    body.position[:] = lowered(setup.system.faces, body.position, body.quaternion, weight)
    _relax(resting, setup.scene.name)
    found, state = resting.state, stepper.state
    state.payload.position[:] = found.payload.position
    state.payload.quaternion[:] = found.payload.quaternion
    state.displacement[:] = found.displacement
    state.rail_moment[:] += setup.system.moving_mass @ found.displacement
    return resting.steps


def _alone(setup: Setup) -> Setup:
    """The same without thrust and friction; their kernels stay the same."""
    model = setup.system.model
    law, friction = model.thrust, model.friction
    if friction is not None:
        friction = friction._replace(static=0.0, dynamic=0.0)
    silent = Thrust(
        pulses=law.pulses and law.pulses._replace(peaks=0.0 * law.pulses.peaks),
        curve=law.curve and law.curve._replace(forces=0.0 * law.curve.forces),
    )
    still = model._replace(thrust=silent, friction=friction)
    latch = setup.system.hold_down
    held = latch and latch._replace(release=np.inf)
    return replace(setup, system=setup.system._replace(model=still, hold_down=held))


def _relax(stepper: Stepper, name: str) -> None:
    """Let the payload fall until it is at rest, or only slides slowly."""
    place = float(stepper.state.payload.position[0])
    stepper.evaluate()
    _stop(stepper, place)
    before, first, touched, begun = 0.0, 0.0, False, 0
    while stepper.steps < _MOST:
        stepper.advance(_STEPS)
        # held before the energy is taken: a payload that would slide has gained speed in these steps
        stepper.state.payload.position[0] = place
        stepper.state.payload.velocity[0] = 0.0
        energy = _kinetic_energy(stepper)
        touched = touched or bool(stepper.state.face_force.any())
        if not np.isfinite(energy):
            raise no_rest(name, "a state that is not finite")
        if energy < before:
            _stop(stepper, place)
            begun = stepper.steps
            if touched:
                first = max(first, before)
                if before <= AT_REST * first:
                    return
            energy = 0.0
        elif touched and _slides(stepper, energy, stepper.steps - begun):
            _stop(stepper, place)
            return
        before = energy
    raise no_rest(name, f"motion after {_MOST:,} steps")


def _slides(stepper: Stepper, energy: float, steps: int) -> bool:
    """Whether the payload, whose energy (J) has grown for so many ``steps``, only slides slowly."""
    if steps < _SLIDING:
        return False
    model = stepper.setup.system.model
    acceleration = np.sqrt(2.0 * energy / model.payload.mass) / (steps * stepper.step)
    assert model.body_force is not None  # since settled.require
    weight = float(np.linalg.norm(model.body_force))
    return bool(acceleration <= _SLOW * weight)


def _kinetic_energy(stepper: Stepper) -> float:
    """Kinetic energy (J) of the payload."""
    body, payload = stepper.state.payload, stepper.setup.system.model.payload
    spin = body.spin @ rotation.single(body.quaternion)
    turning = spin @ payload.inverse_inertia @ spin
    return 0.5 * float(payload.mass * body.velocity @ body.velocity + turning)


def _stop(stepper: Stepper, place: float) -> None:
    """Set all velocities to zero at the present time, half a step after those of the state, and the
    travel to ``place`` (m). Zeros half a step before would raise the energy of the fastest
    waves."""
    state = stepper.state
    state.payload.position[0] = place
    state.payload.velocity[:] = 0.0
    state.payload.spin[:] = 0.0
    state.velocity[:] = 0.0
    state.rail_momentum[:] = 0.0
    stepper.kick(-0.5 * stepper.step)
