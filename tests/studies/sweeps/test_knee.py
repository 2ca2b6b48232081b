"""The end of growth: synthetic laws are recognised, and a knee is found at its place."""

import numpy as np
import pytest

from tipoff.studies.sweeps.knee import growth

SIZES = np.arange(1, 11) / 10.0
KNEE = 0.43
LAWS = {
    "in proportion": lambda s: 12.0 * s,
    "straight": lambda s: 3.0 + 12.0 * s,
    "plateau": lambda s: 12.0 * np.minimum(s, KNEE),
    "slower": lambda s: 12.0 * np.minimum(s, KNEE) + 5.0 * np.maximum(s - KNEE, 0.0),
    "faster": lambda s: 5.0 * s + 20.0 * np.maximum(s - KNEE, 0.0),
    "falls": lambda s: 12.0 * np.minimum(s, KNEE) - 4.0 * np.maximum(s - KNEE, 0.0),
    "levels off": lambda s: 6.0 * -np.expm1(-s / 0.3),
    "ever slower": lambda s: 6.0 * -np.expm1(-s / 0.8),
}


def rates(law, noise: float = 0.03, seed: int = 1) -> np.ndarray:
    """Rates (s,a) that follow ``law`` along the worst of 120 directions, with a scatter from case
    to case."""
    angles = np.arange(120) * (2.0 * np.pi / 120)
    scatter = np.random.default_rng(seed).standard_normal((len(SIZES), len(angles)))
    return abs(law(SIZES)[:, None] * np.cos(angles) * (1.0 + noise * scatter))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_plateau_is_found_where_it_begins(seed):
    found = growth(SIZES, rates(LAWS["plateau"], seed=seed))
    assert found.verdict == "plateau" and found.plateau_share > 0.5
    assert found.low <= KNEE <= found.high and found.high - found.low < 0.2
    assert found.slope_before == pytest.approx(12.0, rel=0.2)


@pytest.mark.parametrize("name", [name for name in LAWS if name != "plateau"])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_no_other_law_passes_for_a_plateau(name, noise):
    """The scatter is smaller than that of the plateau above: with 3 %, "slower" is fitted by the
    levelling law, which has fewer constants."""
    found = growth(SIZES, rates(LAWS[name], noise))
    assert name in found.verdict and found.plateau_share < 0.5
    if name in ("slower", "faster", "falls"):
        assert found.low <= found.knee <= found.high and found.knee == pytest.approx(KNEE, abs=0.05)
    else:
        assert found.knee is None


def test_slopes_of_lines_without_scatter():
    found = growth(SIZES, rates(LAWS["straight"], 0.0))
    assert (found.slope_before, found.slope_after) == pytest.approx(
        (12.0, 12.0)
    ) and found.misfit < 1e-12
    bent = growth(
        SIZES, rates(lambda s: 12.0 * np.minimum(s, 0.4) + 5.0 * np.maximum(s - 0.4, 0.0), 0.0)
    )
    assert (bent.slope_before, bent.slope_after) == pytest.approx((12.0, 5.0), rel=0.02)


def test_a_curve_that_no_law_fits_is_reported():
    found = growth(SIZES, rates(lambda s: 10.0 + 10.0 * np.sin(4.0 * np.pi * s), 0.0))
    assert found.verdict == "none of the laws" and found.misfit > 0.1


def test_cases_that_did_not_settle():
    """A few missing cases change little; sizes without cases are left out; with too few sizes there
    is no result."""
    values = rates(LAWS["plateau"])
    values[3, 5:9] = values[8] = np.nan
    assert growth(SIZES, values).verdict == "plateau"
    values[4:] = np.nan
    assert growth(SIZES, values) is None and growth(SIZES, np.zeros((10, 120))) is None
