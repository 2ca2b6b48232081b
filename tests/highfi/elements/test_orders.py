"""Orders of accuracy over three halvings: displacement h^2, stress h, time dt^2."""

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi import cylinder
from tests.highfi.blocks import ALUMINIUM, block, modes
from tests.highfi.leapfrog import driven, integrate
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.statics import assembly, stable_step

NU = 0.3


def slopes(errors):
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def space_errors(refinement):
    """Relative errors, in the mean square over the volume, of displacement at the nodes and of
    stress at the Gauss points."""
    found = cylinder.solve(refinement, NU)
    exact = elasticity.pressed_cylinder_displacement(
        found.radius, cylinder.INNER, cylinder.OUTER, cylinder.PRESSURE, cylinder.MODULUS, NU
    )
    mean = exact[:, None] * found.mesh.points[:, :2] / found.radius[:, None]
    miss = ((found.displacement[:, :2] - mean) ** 2).sum(axis=1)
    law, corners = hexahedron.elasticity(cylinder.MODULUS, NU), found.mesh.points[found.mesh.cells]
    cells = hexahedron.basis(corners)
    places = np.einsum("aq,cai->cqi", hexahedron.shape_functions(cells), corners)
    stress = elasticity.pressed_cylinder_stress(
        places, cylinder.INNER, cylinder.OUTER, cylinder.PRESSURE, NU
    )
    astray = (
        hexahedron.gauss_strain(corners, law, found.displacement[found.mesh.cells]) @ law - stress
    )
    volume = cells.dx[..., None]
    return (
        np.sqrt((found.mass @ miss) / (found.mass @ exact**2)),
        np.sqrt((volume * astray**2).sum() / (volume * stress**2).sum()),
    )


@pytest.mark.case("O13")
def test_orders_in_space():
    """Lame's cylinder on 4 x 6 to 32 x 48 elements; the size of the errors is checked too, as a
    wrong answer may converge."""
    displacement, stress = zip(*(space_errors(refinement) for refinement in (1, 2, 4, 8)))
    assert (slopes(displacement) > 1.8).all() and (slopes(displacement) < 2.2).all()
    assert (slopes(stress) > 0.8).all() and (slopes(stress) < 1.3).all()
    assert displacement[-1] < 1e-3 and stress[-1] < 0.05


@pytest.mark.case("O13")
def test_order_in_time():
    """A cantilever let go in its first mode follows cos(w t); the error after nine eighths of a
    period falls with the square of the step."""
    mesh = block((10, 1, 2), (0.2, 0.02, 0.02))
    operator = assembly.build(mesh, **ALUMINIUM)
    frequencies, shapes = modes(operator, 1)
    shape, end = shapes[0], 1.125 / frequencies[0]
    node = np.unravel_index(np.argmax(np.abs(shape)), shape.shape)
    fewest = np.ceil(end / (0.9 * stable_step.critical_step(stable_step.element_bound(operator))))

    def error(halvings, centred):
        steps = int(fewest) * 2**halvings
        displacement, velocity = shape.copy(), np.zeros_like(shape)
        if centred:
            times = driven(operator, end / steps, lambda *_: 0.0, displacement, velocity)
            for _ in range(steps):
                next(times)
        else:
            integrate(operator, displacement, velocity, end / steps, steps)
        return abs(displacement[node] / shape[node] - np.cos(2.25 * np.pi))

    errors = [error(halvings, True) for halvings in range(4)]
    assert (slopes(errors) > 1.9).all() and (slopes(errors) < 2.1).all()
    assert errors[0] < 1e-4
    # Control: velocity at rest taken as that of the half step before, which is a start of first
    # order.
    assert (slopes([error(halvings, False) for halvings in range(4)]) < 1.1).all()
