"""Equivalence of distributions, on pairs of samples whose answer is known: its power and its size."""

import numpy as np
import pytest
from scipy.stats import norm
from scipy.stats.mstats import hdquantiles

from tipoff.studies.agreement import equivalence
from tipoff.studies.agreement.distributions import FURTHER
from tipoff.studies.agreement.equivalence import AGREES, MARGIN_SHARE, MISSES, SHARES, UNKNOWN

TRIALS, LIMIT, SD = 60, 0.1, 4.0  # the last two in deg/s
# With as many trials a power of 0.95 is seen as less than 80 % once in 400, one of 0.6 nineteen times
# in twenty; of a size of 1 % more than 5 % are seen once in sixty, of one of 20 % in 93 of 100.
FEWER = 20
MARGIN = MARGIN_SHARE * 2.0 * norm.ppf(0.9) * SD
SPREADS = {"normal": lambda draw: draw, "skewed": lambda draw: np.exp(0.5 * draw) / 0.604}


def trials(draws, correlation, shift=0.0, law="normal", stretch=1.0, count=TRIALS):
    """Share of trials with each verdict. The draws of both models are correlated, and the rate about x
    of the surrogate is ``shift`` (deg/s) farther and ``stretch`` times as wide."""
    generator = np.random.default_rng(7)
    found = []
    for _ in range(count):
        common, one, other = generator.standard_normal((3, draws, 3))
        alone = np.sqrt(1.0 - correlation**2)
        reference, surrogate, further = (
            SD * SPREADS[law](part)
            for part in (
                correlation * common + alone * one,
                correlation * common + alone * other,
                generator.standard_normal((FURTHER * draws, 3)),
            )
        )
        for part in (surrogate, further):
            part[:, 0] = shift + stretch * part[:, 0]
        found.append(equivalence.verdict(equivalence.compare(reference, surrogate, further, LIMIT)))
    return {word: found.count(word) / count for word in (AGREES, MISSES, UNKNOWN)}


@pytest.mark.parametrize(
    "draws, correlation, law, count",
    [
        (32, 0.98, "normal", TRIALS),
        (144, 0.0, "normal", FEWER),
        pytest.param(144, 0.0, "normal", TRIALS, marks=pytest.mark.slow),
        (48, 0.98, "skewed", TRIALS),
    ],
)
def test_power_and_size(draws, correlation, law, count):
    """Equal distributions agree in at least 80 % of the trials; shifted by 1.5 margins in at most 5 %.
    With 32 draws models must follow each other, where they do not 144 are needed. Control: a quarter of
    the draws shows nothing, and accuses nobody."""
    equal = trials(draws, correlation, law=law, count=count)
    assert equal[AGREES] >= 0.8 and equal[MISSES] <= 0.1
    assert trials(draws, correlation, 1.5 * MARGIN, law, count=count)[AGREES] <= 0.05
    few = trials(draws // 4, 0.0, law=law, count=count)
    assert few[AGREES] <= 0.2 and few[UNKNOWN] >= 0.8


@pytest.mark.parametrize(
    "draws, correlation, count",
    [
        (32, 0.98, TRIALS),
        (144, 0.0, FEWER),
        pytest.param(144, 0.0, TRIALS, marks=pytest.mark.slow),
    ],
)
def test_size_at_the_margin(draws, correlation, count):
    """Shifted by one margin, the nearest difference that is none of agreement: at most 5 %."""
    assert trials(draws, correlation, MARGIN, count=count)[AGREES] <= 0.05


def test_a_shift_of_three_margins_is_shown():
    """Not merely that agreement is not shown."""
    assert trials(32, 0.0, 3.0 * MARGIN)[MISSES] >= 0.8


@pytest.mark.parametrize("count", [FEWER, pytest.param(TRIALS, marks=pytest.mark.slow)])
def test_an_equal_median_is_not_enough(count):
    """A distribution about the same median with tails beyond the margin: of 10-90 % distance 2.56 SD, a
    stretch by s moves each end by 1.28 (s - 1) SD, and the margin is 0.64 SD."""
    wider = trials(144, 0.9, stretch=1.0 + 1.5 * 0.5, count=count)
    assert wider[AGREES] <= 0.05 and trials(144, 0.9, count=count)[AGREES] >= 0.8


def test_bounds_cover_the_known_difference():
    """One-sided 95 % bounds of a shift that is known, by a binomial count of 9 quantiles in 100 trials
    of few draws: each bound holds in more than 88 %, which 95 % itself misses with probability 0.003."""
    generator, held = np.random.default_rng(3), np.zeros((2, 9))
    for _ in range(100):
        reference, surrogate = generator.standard_normal((2, 40, 3)) * SD
        further = generator.standard_normal((40 * FURTHER, 3)) * SD
        found = equivalence.compare(reference, surrogate, further, 1e3)  # a margin that is known
        held[0] += [item.low <= 0.0 for item in found]
        held[1] += [item.high >= 0.0 for item in found]
    assert held.min() >= 88.0, held


@pytest.mark.parametrize("count", [8, 33])
def test_quantiles_are_those_of_harrell_and_davis(count):
    values = np.random.default_rng(count).standard_normal((2, count, 3))
    found = equivalence.harrell_davis(values)
    expected = [[hdquantiles(part[:, axis], SHARES) for axis in range(3)] for part in values]
    assert found == pytest.approx(np.array(expected), rel=1e-12)


def test_pairs_count_where_the_models_follow_each_other():
    """The same draws with a small offset: only their comparison draw by draw is narrow. Control: the
    same values in another order."""
    generator = np.random.default_rng(5)
    reference = SD * generator.standard_normal((32, 3))
    further = SD * generator.standard_normal((32 * FURTHER, 3)) + 0.2
    paired = equivalence.compare(reference, reference + 0.2, further, LIMIT)
    shuffled = generator.permutation(reference + 0.2)
    apart = equivalence.compare(reference, shuffled, further, LIMIT)
    assert equivalence.verdict(paired) == AGREES != equivalence.verdict(apart)
    assert all(item.weight > 0.9 for item in paired)
    assert np.mean([item.weight for item in apart]) < 0.3
    difference = [item.difference_deg_s for item in paired]
    assert difference == pytest.approx([0.2] * 9, abs=0.1)


def test_margin_is_the_limit_or_a_share_of_the_spread():
    generator = np.random.default_rng(11)
    values, further = generator.standard_normal((64, 3)), generator.standard_normal((400, 3))
    for scale, expected in ((1e-3, LIMIT), (SD, None)):
        (first, *_) = equivalence.compare(scale * values, scale * values, scale * further, LIMIT)
        low, high = hdquantiles(scale * values[:, 0], [0.1, 0.9])
        assert first.margin_deg_s == pytest.approx(expected or MARGIN_SHARE * (high - low))


def test_more_draws_are_asked_for_by_the_root_of_their_number():
    """32 draws ask for as many as the tests of power above need, or up to twice as many."""
    generator = np.random.default_rng(2)
    found = [
        equivalence.needed(
            equivalence.compare(
                *(SD * generator.standard_normal((count, 3)) for count in (32, 32, 32 * FURTHER)),
                LIMIT,
            ),
            32,
        )
        for _ in range(20)
    ]
    assert 144 <= np.median(found) < 2.5 * 144
    narrow = np.full((8, 3), 1.0)
    assert equivalence.needed(equivalence.compare(narrow, narrow, narrow, LIMIT), 8) == 8


def test_values_without_spread_are_compared_with_the_limit():
    """As of a condition in free flight. Control: one limit farther it misses."""
    one = np.full((8, 3), 2.0)
    assert equivalence.verdict(equivalence.compare(one, one, one, LIMIT)) == AGREES
    far = one + 1.1 * LIMIT
    assert equivalence.verdict(equivalence.compare(one, far, far, LIMIT)) == MISSES


def test_values_that_did_not_settle_are_refused():
    sound = np.zeros((4, 3))
    for spoilt in (sound[:1], np.full((4, 3), np.nan)):
        with pytest.raises(ValueError, match="settled"):
            equivalence.compare(spoilt, sound, sound, LIMIT)


def test_verdicts_do_not_depend_on_the_mean_of_the_rates():
    """Nor do any bounds: a rate of 100 deg/s that both models have."""
    generator = np.random.default_rng(9)
    sets = [SD * generator.standard_normal((count, 3)) for count in (32, 32, 256)]
    middle = equivalence.compare(*sets, LIMIT)
    away = equivalence.compare(*(part + 100.0 for part in sets), LIMIT)
    for one, other in zip(middle, away):
        assert [other.low, other.high, other.width] == pytest.approx(
            [one.low, one.high, one.width], rel=1e-6
        )
