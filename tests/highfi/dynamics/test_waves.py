"""Travelling and standing waves in a column of hexahedra, against the exact solution of the
discrete equations.

With nu = 0 a column moves axially like a bar. It is a thousand times wider than its layers, so that
its lateral modes do not touch the stability limit h / c of the axial ones, and c dt / h = 1 can be
run with the element itself.
"""

import math

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import block
from tests.highfi.leapfrog import integrate
from tipoff.highfi.statics import assembly

LENGTH, LAYERS = 0.5, 100
SPACING = LENGTH / LAYERS
SPEED = elasticity.bar_speed(72e9, 2810.0)


def column(fixed):
    mesh = block((LAYERS, 1, 1), (LENGTH, 1e3 * SPACING, 1e3 * SPACING))
    return mesh.points[:, 0], assembly.build(mesh, 2810.0, 72e9, 0.0, fixed)


@pytest.mark.case("O2")
@pytest.mark.parametrize("mode, hertz", [(1, 2530.9423), (2, 7592.7082), (5, 22774.9155)])
@pytest.mark.parametrize("courant", [0.9, 0.45])
def test_standing_wave_has_the_discrete_frequency(mode, hertz, courant):
    along, operator = column(("mount",))
    step = courant * SPACING / SPEED
    wavenumber = elasticity.fixed_free_wavenumber(mode, LENGTH)
    exact = elasticity.discrete_frequency(wavenumber, SPACING, SPEED, step)
    if courant == 0.9:
        assert exact == pytest.approx(hertz, abs=1e-4)
    displacement = np.zeros((along.size, 3))
    displacement[:, 0] = np.sin(wavenumber * along)
    # v(-1/2) of a cosine in time: u(-1) = u(1) = cos(w dt) u(0).
    velocity = displacement * (1.0 - math.cos(2.0 * math.pi * exact * step)) / step
    steps = round(20.0 / (exact * step))
    trace, _ = integrate(operator, displacement, velocity, step, steps, (int(np.argmax(along)), 0))
    # u(n+1) + u(n-1) = 2 cos(w dt) u(n) for a single frequency; least squares over the whole
    # record.
    cosine = 0.5 * (trace[2:] + trace[:-2]) @ trace[1:-1] / (trace[1:-1] @ trace[1:-1])
    measured = math.acos(cosine) / (2.0 * math.pi * step)
    assert measured == pytest.approx(exact, rel=1e-7)
    # The phase after 20 periods, which no error of the fit can hide.
    phase = 2.0 * math.pi * exact * step * np.arange(steps + 1)
    assert np.abs(trace - trace[0] * np.cos(phase)).max() < 20.0 * 2.0 * math.pi * 1e-7


@pytest.mark.case("O2")
def test_the_continuum_is_distinguished():
    """Control: at 1e-7 the continuum's frequency of mode 5 is 1600 times too far off to pass."""
    wavenumber = elasticity.fixed_free_wavenumber(5, LENGTH)
    discrete = elasticity.discrete_frequency(wavenumber, SPACING, SPEED, 0.9 * SPACING / SPEED)
    continuum = wavenumber * SPEED / (2.0 * math.pi)
    assert continuum == pytest.approx(22778.5252, abs=1e-4)
    assert abs(continuum / discrete - 1.0) > 1e-4


@pytest.mark.case("O2")
def test_step_travels_exactly_at_unit_courant_number():
    along, operator = column(())
    front, steps = 20, 70
    position = np.round(along / SPACING)

    def step_at(place):
        displacement = np.zeros((along.size, 3))
        displacement[:, 0] = position <= place
        return displacement

    step = SPACING / SPEED
    displacement, velocity = step_at(front), (step_at(front) - step_at(front - 1)) / step
    integrate(operator, displacement, velocity, step, steps)
    assert np.abs(displacement - step_at(front + steps)).max() < 1e-12
