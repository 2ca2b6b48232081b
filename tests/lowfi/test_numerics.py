"""The integrator by itself, its stability limit, refused settings, and runs that end without a
result."""

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import PAPER_PAD, scene
from tipoff import lowfi
from tipoff.lowfi.dynamics import dormand_prince as pair
from tipoff.scenes import load


def test_order_conditions_of_the_pair():
    """b and the interpolant at 1 agree, the error weights sum to zero, and quadrature is exact to
    t^4 (order 5) and t^3 (order 4)."""
    weights = np.append(pair.MATRIX[6], 0.0)
    assert pair.DENSE.sum(axis=1) == pytest.approx(weights, abs=1e-14)
    assert pair.MATRIX.sum(axis=1) == pytest.approx(pair.NODES, abs=1e-14)
    assert pair.ERROR.sum() == pytest.approx(0.0, abs=1e-15)
    for power in range(5):
        assert weights @ pair.NODES**power == pytest.approx(1.0 / (power + 1), abs=1e-14)
    for theta in (0.2, 0.5, 0.9):
        dense = pair.DENSE @ theta ** np.arange(1, 5)
        for power in range(4):
            assert dense @ pair.NODES**power == pytest.approx(
                theta ** (power + 1) / (power + 1), abs=1e-13
            )


def test_stable_on_the_whole_half_disc():
    """|R| <= 1 for |z| <= STABLE_RADIUS, Re z <= 0; a disc a tenth larger is not stable
    throughout."""
    angle = np.linspace(np.pi / 2, 3 * np.pi / 2, 721)

    def growth(radius):
        z = radius * np.exp(1j * angle)
        return abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24 + z**5 / 120 + z**6 / 600).max()

    assert all(
        growth(radius) <= 1.0 + 1e-15 for radius in np.linspace(0.0, pair.STABLE_RADIUS, 200)
    )
    assert growth(1.1 * pair.STABLE_RADIUS) > 1.0


@pytest.mark.case("X19")
@pytest.mark.parametrize(
    "bad",
    [
        {"relative_tolerance": 0.0},
        {"relative_tolerance": float("nan")},
        {"speed_floor": -1.0},
        {"maximum_steps": 0},
        {"relative_tolerance": 1.0, "speed_floor": float("inf")},
    ],
)
def test_bad_numerics_are_refused(bad):
    with pytest.raises(ValueError) as refused:
        lowfi.Numerics(**bad)
    assert all(name in str(refused.value) for name in bad)


def test_a_loose_tolerance_stays_below_the_proven_limit():
    """Where the error control would allow longer steps, the limit of the contact bounds them."""
    resting = scene(
        0.05,
        1e-3,
        contact=PAPER_PAD | {"clearance": 0.0},
        gravity={"z": -9.80665},
        initial={"velocity": {"x": 1.0}},
    )
    run = lowfi.run(
        resting, "springs", numerics=lowfi.Numerics(relative_tolerance=1e-2, speed_floor=10.0)
    )
    assert run.status == "time_limit" and 0.5 < run.cost["limit_used"] <= 1.0 + 1e-9
    assert run.checks["energy_error"] < 1.0 and np.abs(run.velocity[:, 2]).max() < 0.1


def test_a_spent_budget_is_a_status_with_a_reason():
    run = lowfi.run(
        load("clamped").condition("phi15"), "springs", numerics=lowfi.Numerics(maximum_steps=20)
    )
    assert run.status == "diverged" and "maximum_steps" in run.message
    assert run.outcome.rate is None and run.time.size >= 1
    assert run.cost["steps"] == 20


def test_overflow_diverges_and_leaves_finite_samples():
    """An energy beyond all numbers ends as a status, with the finite part of the samples."""
    run = lowfi.run(
        load("clamped").replace({"thrust.peak": 1e200, "thrust_offset.misalignment.axial": 0.0}),
        "springs",
    )
    assert run.status == "diverged" and "infinite" in run.message and run.outcome.velocity is None
    assert np.isfinite(run.energy).all() and run.time.size < 1160


def test_cases_of_a_population_have_fewer_cells_and_patterns_at_a_coarse_tolerance():
    """A run has those of the reference at any tolerance, so that its error by the tolerance is that
    of the integration alone. Control: other cells have other bits."""
    assert lowfi.Numerics(relative_tolerance=1e-2).cells == lowfi.Numerics().cells == 16
    many = lowfi.Numerics.of_many(1e-2, 4)
    assert (many.cells, many.degree, many.modes, many.relative_tolerance) == (10, 2, 4, 1e-2)
    assert lowfi.Numerics.of_many(2e-7) == lowfi.Numerics() and many.accurate().cells == 10
    springs = lowfi.Numerics.of_many(1e-2, 0, "springs")  # they have no patterns
    assert springs == lowfi.Numerics(relative_tolerance=1e-2, modes=0)
    asked, compliance = REFERENCE.condition("phi15"), reference_compliance()
    few, default, given = (
        lowfi.run(asked, numerics=lowfi.Numerics(modes=0, **cells), compliance=compliance)
        for cells in ({"cells": 10}, {}, {"cells": 16})
    )
    assert default.numerics["cells"] == 16
    np.testing.assert_array_equal(default.rate, given.rate)
    assert not np.array_equal(default.rate, few.rate)
