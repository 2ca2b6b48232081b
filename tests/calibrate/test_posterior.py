"""The posterior where it is known in closed form, where a model is wrong, and where the curves tell nothing."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import t

import calibrate
import lowfi
from calibrate import Curves, Posterior, chain, discrepancy, motion, parameters
from calibrate.correlation import correlation_time
from calibrate.intervals import independent
from calibrate.objective import Parts
from calibrate.posterior import INTERVAL, Effort, settled_sizes, thinned, told as told_of
from calibrate.profile import profile
from scenes import SceneError
from tests.calibrate.support import CONDITIONS, TRUTH, correlated, own_curves, scene
from tests.lowfi.test_bow import MEAN, standing_away

SMALLEST = 1e-3
SLOPES = 0.1 * np.column_stack([np.ones(60), np.linspace(-1.0, 1.0, 60) ** 2])  # 60 samples, two parameters that act much alike
INDEPENDENT = np.array([[20.0]])  # of those samples, as if each told a third
LONG = chain.Plan(walkers=16, steps=4000, least=1200)


def straight(seed: int):
    """Log density of a straight line through noisy data, and its exact mean and covariance.

    With r = J x - y the density is (N r'r/n + nu s_0^2)^(-(N + nu)/2): a t of N + nu - p degrees of freedom about least squares.
    """
    data = SLOPES @ np.array([0.5, 0.4]) + 0.004 * np.random.default_rng(seed).standard_normal(60)

    def density(shares: np.ndarray) -> float:
        left = SLOPES @ shares - data
        return float(discrepancy.log_likelihood(np.array([[left @ left / 60.0]]), INDEPENDENT, SMALLEST))

    mean, squares, *_ = np.linalg.lstsq(SLOPES, data)
    count = INDEPENDENT.sum()
    freedom = count + discrepancy.FREEDOM - 2
    least = count * squares[0] / 60.0 + discrepancy.FREEDOM * SMALLEST**2
    scale = least / freedom * np.linalg.inv(count * SLOPES.T @ SLOPES / 60.0)
    return density, mean, scale * freedom / (freedom - 2.0)


def start(walkers: int, mean: np.ndarray) -> np.ndarray:
    return mean + 0.02 * np.random.default_rng(1).standard_normal((walkers, mean.size))


@pytest.mark.case("O45")
def test_draws_have_the_mean_and_covariance_of_the_exact_posterior():
    """Within four standard errors of as many independent draws as the chain says it has; the t has tails, which a factor 2 allows
    for. Control: the covariance of white noise, N = n, is a third of it and far outside."""
    density, mean, covariance = straight(3)
    found = chain.sample(density, start(LONG.walkers, mean), LONG, 5)
    assert not found.doubts and found.effective > 500.0
    drawn, deviation = found.shares.reshape(-1, 2), np.sqrt(np.diag(covariance))
    assert (np.abs(drawn.mean(axis=0) - mean) < 4.0 * deviation / np.sqrt(found.effective)).all()
    allowed = 4.0 * np.sqrt(2.0 * 2.0 / found.effective) * np.outer(deviation, deviation)
    assert (np.abs(np.cov(drawn.T) - covariance) < allowed).all()
    assert (np.abs(np.cov(drawn.T) - covariance / 3.0) > allowed).all()


def test_same_seed_same_bits_and_no_other():
    density, mean, _ = straight(3)
    short = chain.Plan(walkers=8, steps=60, least=60)
    np.random.seed(1)
    first = chain.sample(density, start(8, mean), short, 7)
    np.random.seed(2)
    assert (chain.sample(density, start(8, mean), short, 7).shares == first.shares).all()
    assert (chain.sample(density, start(8, mean), short, 8).shares != first.shares).any()
    assert first.doubts and "autocorrelation times" in first.doubts[0]  # 60 steps prove nothing, and it says so


def test_walkers_that_are_stuck_are_called_so():
    """A density of one point: no move is ever accepted."""
    point = np.tile([0.3, 0.6], (8, 1)) + 1e-3 * np.random.default_rng(0).random((8, 2))
    there = {tuple(place) for place in point}
    found = chain.sample(lambda x: 0.0 if tuple(x) in there else -1e6, point, chain.Plan(8, 100, 100), 0)
    assert any("0 % of the moves" in words for words in found.doubts)


def hits(count: int):
    """Whether 95 % intervals of a level hold it, with the discrepancy and with every sample as noise of its own: a surrogate that
    is a constant, beside curves with an error of size 1 that is correlated over some nine samples."""
    generator, grid = np.random.default_rng(45), np.linspace(-2.0, 2.0, 1601)
    for _ in range(count):
        noise = correlated(generator, 400, 0.8)
        squares = (noise.var() + (noise.mean() - grid) ** 2)[:, None, None]
        one = correlation_time([noise - noise.mean()])
        held = []
        for samples in (400.0 / one, 400.0):
            weight = np.exp((log := discrepancy.log_likelihood(squares, np.array([[samples]]), SMALLEST)) - log.max())
            low, high = np.interp([0.025, 0.975], np.cumsum(weight) / weight.sum(), grid)
            held.append(low <= 0.0 <= high)
        yield held


@pytest.mark.case("O45")
def test_intervals_hold_the_truth_beside_a_model_that_is_wrong():
    """At least nine in ten of 400; the correlation is read off the same 400 samples, which costs some of the 95 %. Control: without
    the discrepancy not even six in ten do."""
    with_it, without = np.sum(list(hits(400)), axis=0)
    assert with_it >= 360, with_it
    assert without < 240, without


def to_first_negative(curve: np.ndarray) -> float:
    """1 + 2 sum rho_k up to the first rho_k that is not positive: the weaker rule."""
    rho = np.array([curve[:-lag] @ curve[lag:] for lag in range(1, curve.size)]) / (curve @ curve)
    return 1.0 + 2.0 * rho[:np.argmax(rho <= 0.0)].sum()


def test_correlated_samples_of_several_curves_count_together():
    """(1 + rho)/(1 - rho), and no less; beyond, sums over many lags scatter by some 10 % of it. A slow error under one that swings
    is not taken for noise, neither here nor in linear intervals. Control: up to the first negative lag every sample would count."""
    generator = np.random.default_rng(2)
    curves = [correlated(generator, 300, 0.8) for _ in range(60)]
    assert 9.0 <= correlation_time(curves) < 9.0 * 1.3
    assert correlation_time([np.zeros(10)]) == 1.0
    swinging = [curve + 1.5 * (-1.0) ** np.arange(300) for curve in curves]
    assert correlation_time(swinging) > 3.0 and to_first_negative(swinging[0]) == 1.0
    assert independent(swinging[0]) == 300.0 / correlation_time(swinging[:1]) < 150.0


def test_a_curve_counts_no_more_often_than_pads_touched():
    """White noise of 90 samples, in one curve with three touches, in one with an unknown number."""
    noise = np.random.default_rng(4).standard_normal((2, 90, 4))
    found = discrepancy.error([Parts(item[:, 0], item[:, 1:], np.zeros(3)) for item in noise], [3, None])
    assert (found.counts[0] == 3.0).all() and (found.counts[1] > 20.0).all()
    assert Curves.from_trajectory(own_curves()["phi60"]).touches == 3


def test_an_untold_constant_gets_no_interval_and_a_told_one_does():
    """The density knows the first share alone: the second is as it was before."""
    plan = chain.Plan(walkers=12, steps=1500, least=600)
    first = np.random.default_rng(0).random((12, 2))
    found = chain.sample(lambda x: -0.5 * ((x[0] - 0.5) / 0.05) ** 2, first, plan, 1)
    items = parameters.free(scene())[:2]
    told = told_of(items, found.shares.reshape(-1, 2), np.array([0.5, 0.5]))
    assert told["intervals"][1] is None and told["spread"][1] == pytest.approx(1.0, abs=0.1)
    assert len(told["notes"]) == 1 and "contact.exponent: its posterior is its prior" in told["notes"][0]
    assert told["intervals"][0] == pytest.approx([items[0].value(0.5 - 0.098), items[0].value(0.5 + 0.098)], rel=0.05)


def test_an_interval_that_ends_at_a_bound_says_so():
    shares = np.column_stack([np.abs(0.05 * np.random.default_rng(0).standard_normal(4000)), np.linspace(0.4, 0.5, 4000)])
    told = told_of(parameters.free(scene())[:2], shares, np.array([0.0, 0.45]))
    assert len(told["notes"]) == 1 and "contact.force: the interval ends at its lower bound" in told["notes"][0]


def test_profile_of_a_parabola_is_the_one_of_the_inverse_information():
    """P_i = -(x - m)^2 / (2 V_ii). Control: a cut, nothing found again, falls by the other factor, H_ii V_ii = 5 here."""
    matrix = np.array([[500.0, 400.0], [400.0, 400.0]])
    covariance, middle = np.linalg.inv(matrix), np.array([0.5, 0.5])
    drawn = middle + np.random.default_rng(1).multivariate_normal(np.zeros(2), covariance, 400)

    def density(x):
        return float(-0.5 * (x - middle) @ matrix @ (x - middle))

    grid, values = profile(density, drawn, np.array([density(x) for x in drawn]), 0, points=5, evaluations=60)
    np.testing.assert_allclose(values, -0.5 * (grid - 0.5) ** 2 / covariance[0, 0], atol=0.02)
    assert density(np.array([grid[0], 0.5])) < 4.0 * values[0]


def test_size_of_the_settled_error_is_its_root_mean_square():
    errors = 0.05 * np.random.default_rng(3).standard_normal((500, 3))
    assert settled_sizes(list(errors)) == pytest.approx([0.05] * 3, rel=0.1)


def test_a_reduced_run_is_the_run_and_curves_are_read_where_it_has_samples():
    """Bit by bit. Control: on samples half a step aside straight lines across a touch move the rates by some per cent."""
    coarse = scene().replace({"output.interval": INTERVAL, **TRUTH}).condition("phi60")
    whole, reduced = lowfi.run(coarse), motion.run(coarse)
    assert reduced.status == whole.status == "exited" and reduced.outcome == whole.outcome
    assert all((getattr(reduced, name) == getattr(whole, name)).all() for name in ("time", "velocity", "rate"))
    curves = thinned(Curves.from_trajectory(own_curves()["phi60"]))
    amplitude = np.abs(curves.rate).max()
    assert np.abs(curves.rate - whole.rate[:curves.time.size]).max() < 1e-4 * amplitude
    aside = np.column_stack([np.interp(curves.time + 0.5 * INTERVAL, whole.time, column) for column in whole.rate.T])
    exact = np.column_stack([np.interp(curves.time + 0.5 * INTERVAL, own_curves()["phi60"].time, column)
                             for column in own_curves()["phi60"].rate.T])
    assert np.abs(aside - exact).max() > 1e-2 * amplitude


def calibrated() -> SimpleNamespace:
    """What a posterior reads of a calibration that found the truth."""
    free = parameters.free(scene())
    return SimpleNamespace(parameters=[item.name for item in free], values=[item.read(scene().replace(TRUTH)) for item in free])


@pytest.fixture(scope="module")
def drawn() -> Posterior:
    """The surrogate's own curves: a model that is right, and a chain that is far too short."""
    return calibrate.posterior(scene(), own_curves(), calibrated(), effort=Effort(chain.Plan(12, 50, 50), 3, 4, 200))


def test_a_warm_scene_stands_on_its_rigid_walls():
    """Walls 50 um wider where they are warm: the surrogate's own curves there leave next to nothing. Controls: walls that stand as
    cold ones do leave some per cent, and without any nothing is drawn."""
    warm = scene().replace({"thermal.mean": MEAN, "flexibility.modes": 4})
    wide, straight = (standing_away(warm, np.full(4, distance)) for distance in (5e-5, 0.0))
    curves = {name: lowfi.run(warm.replace(TRUTH | {"flexibility": None}).condition(name), walls=wide) for name in CONDITIONS}
    least = Effort(chain.Plan(12, 4, 4), 2, 2, 10)
    found = [calibrate.posterior(warm, curves, calibrated(), effort=least, walls=walls, workers=workers)
             for walls, workers in ((wide, 1), (straight, 1), (straight, 2))]
    sizes = [item.errors["rate_y"]["relative_size"] for item in found]
    assert sizes[0] < 2e-3 and sizes[1] > 1e-2
    assert found[1] == found[2]  # threads finish in any order
    with pytest.raises(SceneError, match="thermal"):
        calibrate.posterior(warm, curves, calibrated(), effort=least)


def test_exact_curves_give_the_constants_back_and_say_what_they_do_not_tell(drawn):
    """No residual, so the discrepancy is the smallest allowed; a thousandth of the rates tells the force to some per cent."""
    assert drawn.parameters[-1] == "contact.damping_depth"
    low, high = drawn.intervals[0]
    assert low <= 300.0 <= high and high - low < 15.0
    assert drawn.errors["rate_y"]["relative_size"] < 2e-3
    assert drawn.chain["doubts"] and drawn.conditions == list(CONDITIONS)
    assert all(max(item["drop"]) == 0.0 for item in drawn.profile.values())


def test_draws_are_overrides_of_the_scene_and_travel_as_a_file(drawn, tmp_path):
    (tmp_path / "posterior.json").write_text(json.dumps(drawn.as_dict(), allow_nan=False))
    read = Posterior.load(tmp_path / "posterior.json")
    assert read == drawn
    rows = calibrate.draws(read, 5, seed=2)
    assert rows == calibrate.draws(drawn, 5, seed=2) != calibrate.draws(drawn, 5, seed=3)
    changed = scene().replace(rows[0])
    assert changed.contact.stiffness == rows[0]["contact.stiffness"] and changed.friction.static == rows[0]["friction.static"]
    (tmp_path / "posterior.json").write_text("{}")
    with pytest.raises(ValueError, match="not a posterior"):
        Posterior.load(tmp_path / "posterior.json")


def test_disturbed_rates_scatter_as_the_t_they_are_drawn_from(drawn):
    """Median of |t| times size times |w|; a draw of larger size scatters more."""
    many = np.tile(np.array([3.0, 0.0, 4.0]), (200, 50, 1))
    found = calibrate.disturbed(drawn, many, np.arange(200)) - many
    size = np.array(drawn.settled_size)[:200]
    shown = np.median(np.abs(found) / (5.0 * size[:, None, :]))
    assert shown == pytest.approx(t.ppf(0.75, drawn.settled_freedom), rel=0.05)
