"""The momentum balances where momenta cancel: the scale is the sum of the magnitudes of all parts, and
a real error is still seen."""

import numpy as np
import pytest

from tipoff.mechanics import momenta, promises

TIME = np.linspace(0.0, 0.05, 6)
STILL = np.zeros((TIME.size, 3))
NOTHING = np.zeros((TIME.size, 6))


def errors(bodies, values=NOTHING, given=NOTHING, weight=0.0, reach=0.0):
    """Errors of the balance of ``bodies`` (mass, place, velocity, spin) by the surrogate's promises."""
    impulses = momenta.impulses(TIME, given, np.zeros((TIME.size, 1, 3)), weight)
    sums = momenta.Sums(values, given, momenta.of_bodies(bodies), impulses, reach)
    return momenta.errors(sums, promises.RIGID)


def constant(*vector):
    return np.tile(vector, (TIME.size, 1))


def with_error(relative, slot):
    """A sum of momenta that is zero at first and ``relative`` at last."""
    values = NOTHING.copy()
    values[-1, slot] = relative
    return values


def assert_rounding_is_allowed_and_an_error_seen(asked, slot, size):
    """Rounding of the parts is no error; a thousand times the promise is (control)."""
    place = 0 if slot < 3 else 1
    promised = (promises.RIGID.linear_momentum_error, promises.RIGID.angular_momentum_error)[place]
    assert errors(**asked, values=with_error(1e-15 * size, slot))[place] <= promised
    assert errors(**asked, values=with_error(1e3 * promised * size, slot))[place] > promised


@pytest.mark.parametrize("slot", [0, 1, 2])
def test_two_bodies_whose_momenta_cancel(slot):
    """Two rails on either side of a platform that turns. The momentum of the whole is rounding."""
    moving = constant(*np.eye(3)[slot])
    pair = [(4.0, STILL, moving, STILL), (4.0, STILL, -moving, STILL)]
    at_rest = (10.0, STILL, 1e-18 * moving, STILL)
    assert_rounding_is_allowed_and_an_error_seen({"bodies": [at_rest, *pair]}, slot, 8.0)


def test_spins_and_orbits_that_cancel():
    """A spin about z against the orbit of a body about the origin."""
    orbit = (2.0, constant(0.5, 0.0, 0.0), constant(0.0, 1.0, 0.0), STILL)
    spin = (1.0, STILL, STILL, constant(0.0, 0.0, -1.0))
    assert_rounding_is_allowed_and_an_error_seen({"bodies": [orbit, spin]}, 5, 2.0)


def test_a_body_that_falls_along_its_own_place():
    """r x m v of a body that falls far is zero as a difference of large terms."""
    fallen = 4903.325 * TIME**2
    place, velocity = np.outer(fallen, [0, 0.6, 0.8]), np.outer(9806.65 * TIME, [0, 0.6, 0.8])
    size = 10.0 * fallen[-1] * 9806.65 * TIME[-1]
    asked = {"bodies": [(10.0, place, velocity, STILL)]}
    assert_rounding_is_allowed_and_an_error_seen(asked, 3, size)


@pytest.mark.parametrize("slot, size", [(1, 1.0), (4, 0.3)])
def test_weight_that_the_ground_carries(slot, size):
    """A load of 10 kg that moves slowly along its rail at 1000 g. The impulses of weight and ground
    cancel, the samples show no force of a pad, and the moments are those about the origin."""
    weight, along = 10.0 * 9806.65, constant(1e-3, 0.0, 0.0)
    asked = {"bodies": [(10.0, STILL, along, STILL)], "weight": weight, "reach": 0.3}
    assert_rounding_is_allowed_and_an_error_seen(asked, slot, weight * TIME[-1] * size)
    # control: without the weight the same rounding would be an error
    alone = asked | {"weight": 0.0}
    lost = with_error(1e-14 * weight * TIME[-1] * size, slot)
    assert max(errors(**alone, values=lost)) > promises.RIGID.angular_momentum_error
