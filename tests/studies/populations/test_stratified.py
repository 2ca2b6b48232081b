"""The upper bound of a probability from strata of the surrogate, on populations with known answers."""

import math

import numpy as np
import pytest
from scipy import stats

from tipoff.studies.populations import exceedance, stratified
from tipoff.studies.populations.stratified import Runs

REPETITIONS = 400
CONFIDENCE = 0.95
NEAR = 0.5  # of the surrogate's margin
CASES, RUNS = 20_000, 300


def test_runs_without_the_event_leave_the_bound_of_their_number():
    """Two hundred plain runs: 1.5 %, the root of (1 - p)^200 = 0.05. Strata cannot make it less."""
    plain = exceedance.at_most(0, 200, CONFIDENCE)
    assert plain == pytest.approx(1.0 - 0.05 ** (1 / 200)) == pytest.approx(0.0149, rel=0.01)
    found = stratified.upper_bound((0, 0, CASES), Runs(0, 0), Runs(200, 0), CONFIDENCE)
    # 0.035 in place of 0.05, and weights that are not known exactly
    assert found.far_share == pytest.approx(1.0 - 0.035 ** (1 / 200))
    assert plain < found.far_share < found.upper < 1.15 * plain and found.estimate == 0.0


def test_the_bound_is_that_of_its_shares_and_weights():
    """Clopper and Pearson by quantiles of the beta distribution; the parts of the error probability
    add up to 5 %. Cases above count with certainty, near ones with their share, all others with
    theirs."""
    parts = {"far": 0.035, "near": 0.01, "above": 0.0025, "above or near": 0.0025}
    assert sum(parts.values()) == pytest.approx(0.05)

    def most(part: str, events: int, runs: int) -> float:
        return float(stats.beta.ppf(1.0 - parts[part], events + 1, runs - events))

    above, within = most("above", 40, 2000), most("above or near", 200, 2000)
    near, far = most("near", 3, 30), most("far", 1, 170)
    found = stratified.upper_bound((40, 160, 1800), Runs(30, 3), Runs(170, 1), CONFIDENCE)
    assert (found.near_share, found.far_share) == pytest.approx((near, far), rel=1e-9)
    expected = above + (within - above) * near + (1.0 - within) * far
    assert found.upper == pytest.approx(expected, rel=1e-9)
    assert found.estimate == pytest.approx((40 + 160 * 3 / 30 + 1800 / 170) / 2000)


def test_the_allocation_is_the_best_of_all():
    cases = (100, 300, 19_600)
    errors = (0.2 * 0.05, 0.7 * 0.05)

    def bound(near: int) -> float:
        parts = zip(cases[1:], errors, (near, RUNS - near))
        return sum(-count * math.log(error) / runs for count, error, runs in parts)

    near, far = stratified.allocated(cases, RUNS, CONFIDENCE)
    assert near + far == RUNS and near == min(range(1, RUNS), key=bound)
    assert stratified.allocated((5, 3, 8), 200, CONFIDENCE) == (3, 8)
    assert stratified.allocated((5, 0, 800), 200, CONFIDENCE) == (0, 200)
    assert stratified.allocated((5, 2, 800), 200, CONFIDENCE) == (2, 198)


def study(random, bias: float, noise: float):
    """Cases and runs of one study, and the events of as many plain runs. The margin x of a case is
    normal about 2.5; the surrogate shows the event where x < 0, the reference where x < bias +
    noise e."""
    x = random.normal(2.5, 1.0, CASES)
    event = x < bias + noise * random.normal(size=CASES)
    places = [np.flatnonzero(part) for part in (x < 0.0, (x >= 0.0) & (x < NEAR), x >= NEAR)]
    cases = tuple(part.size for part in places)
    runs = stratified.allocated(cases, RUNS, CONFIDENCE)
    near, far = (
        Runs(count, int(event[part[:count]].sum())) for part, count in zip(places[1:], runs)
    )
    return cases, near, far, int(event[:RUNS].sum())


@pytest.mark.parametrize(
    ("bias", "noise"), [(0.3, 0.05), (0.0, 0.2), (0.8, 0.02), (0.3, 0.3), (0.0, 0.0)]
)
def test_the_bound_holds_as_often_as_it_says_and_says_something(bias, noise):
    """P = Phi((bias - 2.5) / sqrt(1 + noise^2)). The bound may hold more often than 95 %, as that of
    Clopper and Pearson does. Control: that of the surrogate alone, which knows no bias."""
    random = np.random.default_rng(1)
    truth = float(stats.norm.cdf((bias - 2.5) / math.hypot(1.0, noise)))
    studies = [study(random, bias, noise) for _ in range(REPETITIONS)]
    found = [stratified.upper_bound(*each[:3], CONFIDENCE).upper for each in studies]
    assert np.mean(np.array(found) >= truth) > 0.94
    assert np.median(found) < truth + 0.03
    if bias:
        alone = [exceedance.at_most(each[0][0], CASES, CONFIDENCE) for each in studies]
        assert np.mean(np.array(alone) >= truth) < 0.05


def test_strata_leave_less_to_chance_than_plain_runs():
    """Bounds of plain runs scatter with the number of events among them."""
    random = np.random.default_rng(3)
    studies = [study(random, 0.2, 0.05) for _ in range(REPETITIONS)]
    found = [stratified.upper_bound(*each[:3], CONFIDENCE).upper for each in studies]
    plain = [exceedance.at_most(each[3], RUNS, CONFIDENCE) for each in studies]
    assert np.std(found) < 0.5 * np.std(plain)


def test_a_stratum_without_runs_counts_in_full():
    found = stratified.upper_bound((10, 20, 970), Runs(0, 0), Runs(100, 0), CONFIDENCE)
    assert found.near_share == 1.0 and found.upper > 0.03 and found.estimate == pytest.approx(0.03)
