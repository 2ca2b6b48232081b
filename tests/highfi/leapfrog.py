"""The plain central difference loop: the operator under test and, optionally, nodal forces.

v(n+1/2) = v(n-1/2) - dt M^-1 K u(n),    u(n+1) = u(n) + dt v(n+1/2)
"""

import numpy as np

from tipoff.highfi.state.nodes import kick_nodes
from tipoff.highfi.statics.operator import internal_force
from tipoff.kernels.jit import njit


def integrate(operator, displacement, velocity, step, steps, watched=(0, 0)):
    """Advance displacement and velocity, both (n,3), in place; velocity lags by half a step.

    Returns the displacement (steps+1,) of the watched (node, component), and the invariant (steps,)
    of case O14, v(n+1/2)' M v(n+1/2) / 2 + u(n)' K u(n+1) / 2.
    """
    inverse_mass = np.where(operator.free, 1.0 / operator.mass, 0.0)
    return _integrate(
        displacement,
        velocity,
        step,
        steps,
        watched[0],
        watched[1],
        operator.cells,
        operator.shape_class,
        operator.stiffness,
        operator.mass,
        inverse_mass,
    )


@njit
def _integrate(
    displacement,
    velocity,
    step,
    steps,
    node,
    component,
    cells,
    shape_class,
    stiffness,
    mass,
    inverse_mass,
):
    force = np.empty_like(displacement)
    trace = np.empty(steps + 1)
    invariant = np.empty(steps)
    trace[0] = displacement[node, component]
    for n in range(steps):
        internal_force(displacement, cells, shape_class, stiffness, force)
        energy = 0.0
        for a in range(mass.size):
            for c in range(3):
                velocity[a, c] -= step * inverse_mass[a] * force[a, c]
                displacement[a, c] += step * velocity[a, c]
                energy += 0.5 * (mass[a] * velocity[a, c] ** 2 + force[a, c] * displacement[a, c])
        invariant[n] = energy
        trace[n + 1] = displacement[node, component]
    return trace, invariant


def driven(operator, step, load, displacement, velocity):
    """Advance displacement and velocity, both (n,3), in place by the product's own kick, under
    nodal forces.

    load(time, displacement) gives them in N, in any shape that broadcasts to (n,3). The velocity
    given is that at the start; from then on it lags by half a step. Yields the time (s) of the
    displacement after each step, without end.
    """
    inverse_mass = np.where(operator.free, 1.0 / operator.mass, 0.0)
    cells, shape_class, stiffness = operator.cells, operator.shape_class, operator.stiffness
    resistance = np.empty_like(displacement)
    number = 0
    while True:
        internal_force(displacement, cells, shape_class, stiffness, resistance)
        resistance -= load(number * step, displacement)
        kick_nodes(
            inverse_mass, velocity, resistance, (0.0, 0.0, 0.0), step if number else 0.5 * step
        )
        displacement += step * velocity
        number += 1
        yield number * step
