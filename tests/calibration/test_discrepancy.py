"""Model error in intervals: against dense matrices, on processes that are known, and on runs of the
surrogate with something that the fit lacks."""

import numpy as np
import pytest

from tipoff.calibration import discrepancy
from tipoff.calibration.discrepancy import RATE, VELOCITY, Curve

TIME = np.linspace(0.0, 0.05, 301)
NOISE, DEVIATION = 0.02, 0.1


def wiener(generator) -> np.ndarray:
    """A path (n,) of standard deviation 1 at the end."""
    steps = np.sqrt(np.diff(np.append(0.0, TIME)) / TIME[-1])
    return np.cumsum(steps * generator.standard_normal(TIME.size))


def lines(generator, deviation: float, count: int = 6) -> list[Curve]:
    """Curves 3 + 2 t/T with noise and an error of the model, of which a line through both is left
    over; half of them are of v_x."""
    slope = np.column_stack([np.ones(TIME.size), TIME / TIME[-1]])
    paths = [
        NOISE * generator.standard_normal(TIME.size) + deviation * wiener(generator)
        for _ in range(count)
    ]
    fitted = np.linalg.lstsq(np.vstack(count * [slope]), np.concatenate(paths), rcond=None)[0]
    return [
        Curve(TIME, path - slope @ fitted, slope, 1.0, (VELOCITY, RATE)[number % 2])
        for number, path in enumerate(paths)
    ], fitted


def dense(curve: Curve, deviation: float) -> np.ndarray:
    """The covariance (n,n) itself."""
    gained = np.cumsum(curve.steps(deviation))
    return np.minimum.outer(gained, gained) + curve.noise * np.eye(TIME.size)


@pytest.mark.parametrize("deviation", [1e-4, 0.01, 1.0])
def test_the_banded_solution_is_that_of_the_dense_covariance(deviation):
    (curve, *_), _ = lines(np.random.default_rng(3), 0.3)
    columns = np.column_stack([curve.slope, curve.left])
    found, log = discrepancy.whitened(curve, deviation, columns)
    covariance = dense(curve, deviation)
    np.testing.assert_allclose(found, np.linalg.solve(covariance, columns), rtol=1e-6, atol=1e-6)
    assert log == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-9)


def test_deviations_are_those_of_dense_matrices():
    """One curve: A (K + v I) A'. Two: the deviations by model error are added, not their squares."""
    curves, _ = lines(np.random.default_rng(4), 0.3, 2)
    weights = [curve.weight for curve in curves]
    inverse = np.linalg.inv(sum(w * c.slope.T @ c.slope for w, c in zip(weights, curves)))
    shares = [w * inverse @ c.slope.T for w, c in zip(weights, curves)]
    by_noise = sum(c.noise * (a**2).sum(axis=1) for a, c in zip(shares, curves))
    by_model = sum(
        np.sqrt(np.diag(a @ (dense(c, 0.2) - c.noise * np.eye(TIME.size)) @ a.T))
        for a, c in zip(shares, curves)
    )
    scatter, whole = discrepancy.deviations(curves, (0.2, 0.2), np.eye(2))
    np.testing.assert_allclose(whole, np.sqrt(by_noise + by_model**2), rtol=1e-9)
    np.testing.assert_allclose(scatter, np.sqrt(np.diag(inverse)), rtol=1e-12)


def test_the_size_of_a_known_error_is_found_and_noise_is_no_error():
    """The steps of a path, a twelfth of the variance of the noise, count in part as noise. Control:
    white noise alone leaves little error."""
    generator = np.random.default_rng(5)
    found = [discrepancy.likeliest(lines(generator, DEVIATION)[0]) for _ in range(6)]
    np.testing.assert_allclose(np.mean(found, axis=0), DEVIATION, rtol=0.1)
    alone = discrepancy.likeliest(lines(generator, 0.0)[0])
    assert alone[RATE] < 0.02 and alone[VELOCITY] < 0.02


@pytest.mark.case("O74")
@pytest.mark.parametrize(
    ("fits", "least"), [(40, 37), pytest.param(100, 93, marks=pytest.mark.slow)]
)
def test_intervals_with_model_error_cover_and_those_of_scatter_do_not(fits, least):
    """Fits of two constants. The deviations of curves that are independent are added too, so that
    more than 95 % are covered: 95 % itself is below 37 of 40, and below 93 of 100, once in seven.
    Control: intervals of the scatter alone cover less than half."""
    generator, hits = np.random.default_rng(6), np.zeros((2, 2))
    for _ in range(fits):
        curves, error = lines(generator, DEVIATION)
        errors = discrepancy.likeliest(curves)
        for row, deviation in zip(hits, discrepancy.deviations(curves, errors, np.eye(2))):
            row += np.abs(error) <= 1.96 * deviation
    scatter, whole = hits
    assert (whole >= least).all() and (scatter < 0.5 * fits).all(), hits


def test_the_deviation_is_the_likeliest_of_what_no_parameter_moves():
    """Restricted likelihood by its definition: that of the combinations of samples which are
    orthogonal to all slopes, of one curve with many parameters. Control: the likelihood of all
    samples about the fit has its top at a smaller deviation."""
    time = np.linspace(0.001, 0.05, 50)
    generator, count = np.random.default_rng(7), 12
    slope = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, time.size), count - 1)
    path = 0.3 * np.cumsum(generator.standard_normal(time.size)) / np.sqrt(time.size)
    path -= slope @ np.linalg.lstsq(slope, path, rcond=None)[0]
    curve = Curve(time, path, slope, 1.0, RATE)
    others = np.linalg.svd(slope)[0][:, count:]

    def surprise(deviation: float, seen: np.ndarray) -> float:
        gained = np.cumsum(curve.steps(deviation))
        covariance = np.minimum.outer(gained, gained) + curve.noise * np.eye(time.size)
        inner, left = seen.T @ covariance @ seen, seen.T @ path
        return np.linalg.slogdet(inner)[1] + left @ np.linalg.solve(inner, left)

    grid = np.geomspace(0.01, 1.0, 2001)
    restricted, plain = (
        grid[np.argmin([surprise(deviation, seen) for deviation in grid])]
        for seen in (others, np.eye(time.size))
    )
    found = discrepancy.likeliest([curve])[RATE]
    assert found == pytest.approx(restricted, rel=5e-3)
    assert plain < 0.95 * restricted
