"""Draws by case number: the same bits for any division into parts, and statistics of closed
forms."""

import numpy as np
import pytest
from scipy import stats

from tipoff.faults import SceneError
from tipoff.lowfi.ensemble import sampling
from tipoff.lowfi.ensemble.rows import Drawn, numbers
from tipoff.lowfi.ensemble.sampling import Points
from tipoff.scenes import load, uncertainty
from tipoff.scenes.distributions import BY_NAME
from tipoff.scenes.uncertainty import Uncertainty


def drawn(cases: int, how: str, seed: int = 1, **vary) -> Uncertainty:
    """``vary`` holds the bounds of uniform distributions by name."""
    tables = {
        name: BY_NAME["uniform"].model_construct(distribution="uniform", low=low, high=high)
        for name, (low, high) in vary.items()
    }
    return Uncertainty(cases, seed, how, tables)


@pytest.mark.parametrize("how", ["random", "latin-hypercube", "sobol"])
@pytest.mark.parametrize("size", [1, 4, 6])
def test_any_cut_has_the_same_bits(how, size):
    asked = drawn(1000, how, **{f"k{n}": (0.0, 1.0) for n in range(size)})
    whole = Points(asked).draw(0, 1000)
    points = Points(asked)
    for begin, end in ((512, 1000), (0, 1), (999, 1000), (1, 512), (300, 301)):
        assert np.array_equal(points.draw(begin, end), whole[begin:end])
    assert ((whole > 0.0) & (whole < 1.0)).all() and len(np.unique(whole, axis=0)) == 1000
    assert not np.array_equal(Points(asked._replace(seed=2)).draw(0, 1000), whole)


def test_a_case_far_out_costs_no_more_than_the_first():
    """Plain sampling reaches case 10^12 at once, which no generator that has to be wound forward
    would."""
    assert Points(drawn(2**40, "random", a=(0.0, 1.0))).draw(10**12, 10**12 + 1).shape == (1, 1)


def test_each_kind_of_sampling():
    asked = drawn(256, "random", a=(0.0, 1.0), b=(0.0, 1.0))
    plain, hypercube, sobol = (
        Points(asked._replace(sampling=how)).draw(0, 256)
        for how in ("random", "latin-hypercube", "sobol")
    )

    def filled(points, cells):
        return len(np.unique(np.floor(points * cells), axis=0))

    for column in hypercube.T:
        assert filled(column, 256) == 256
    assert filled(sobol, 16) == 256  # one point in each elementary square
    # about 1 - 1/e of them: neither happens by chance
    assert filled(plain, 16) < 200 and filled(plain[:, 0], 256) < 200
    many = Points(drawn(20_000, "random", a=(0.0, 1.0), b=(0.0, 1.0))).draw(0, 20_000)
    assert all(stats.kstest(column, "uniform").pvalue > 1e-3 for column in many.T)
    assert abs(np.corrcoef(many.T)[0, 1]) < 4.0 / np.sqrt(20_000)


def test_what_cannot_be_held_is_refused(monkeypatch):
    monkeypatch.setattr(sampling, "MOST_HELD", 1000)
    with pytest.raises(SceneError, match="at most 500 cases"):
        Points(drawn(501, "latin-hypercube", a=(0.0, 1.0), b=(0.0, 1.0)))
    Points(drawn(501, "sobol", a=(0.0, 1.0), b=(0.0, 1.0)))


@pytest.mark.case("O47")
def test_variance_shares_of_the_linear_tip_off():
    """w = (J l/I) t cos f1 + (J/I)(r cos f2 + m cos f3): the terms are independent with mean zero,
    so variances add up.

    The error of a variance from n draws is sqrt((m4 - m2^2)/n), with the exact moments of each
    term: those of a normal times a cosine, m4 = 3 s^4 * 3/8.
    """
    normal = {
        name: {"distribution": "normal", "mean": 0.0, "sd": sd}
        for name, sd in (
            ("thrust_offset.misalignment.axial", np.deg2rad(0.4 / 3.0)),
            ("initial.position.y", 0.2e-3),
            ("initial.position.z", 0.4e-3 / 3.0),
        )
    }
    angles = {
        name: {"distribution": "uniform", "low": 0.0, "high": 2.0 * np.pi}
        for name in (
            "thrust_offset.misalignment.radial",
            "thrust_offset.eccentricity.radial",
            "mass_offset.eccentricity.radial",
        )
    }
    count = 200_000
    source = Drawn(
        uncertainty.parse(
            {"cases": count, "seed": 3, "vary": normal | angles},
            load("clamped"),
            bare_numbers_are_si=True,
        )
    )
    t, r, m, f1, f2, f3 = np.concatenate(
        [numbers(source.keys, source.rows(n, n + 50_000)) for n in range(0, count, 50_000)]
    ).T
    impulse, arm, inertia = 100.0, 0.15, 0.55
    terms = np.degrees(
        impulse / inertia * np.stack([arm * t * np.cos(f1), r * np.cos(f2), m * np.cos(f3)])
    )
    sds = np.degrees(
        impulse / inertia * np.array([arm * np.deg2rad(0.4 / 3.0), 0.2e-3, 0.4e-3 / 3.0])
    )
    exact = 0.5 * sds**2
    errors = np.sqrt((9.0 / 8.0 * sds**4 - exact**2) / count)
    variances = terms.var(axis=1)
    assert (abs(variances - exact) < 3.0 * errors).all()
    assert np.sqrt(exact.sum()) == pytest.approx(3.121965, abs=1e-6)
    assert exact / exact.sum() == pytest.approx([0.678342, 0.222686, 0.098972], abs=1e-6)
    # A sum of independent terms: they are uncorrelated in any of the draws.
    total = terms.sum(axis=0).var()
    covariances = 2.0 * np.sqrt(
        sum(exact[i] * exact[j] for i, j in ((0, 1), (0, 2), (1, 2))) / count
    )
    assert abs(total - variances.sum()) < 3.0 * covariances


@pytest.mark.case("O46")
def test_sobol_indices_of_ishigami():
    """SciPy's indices take our distributions as they are; the function and its indices: Ishigami
    and Homma 1990, a = 7, b = 0.1."""
    angle = BY_NAME["uniform"].model_construct(distribution="uniform", low=-np.pi, high=np.pi)
    found = stats.sobol_indices(
        func=lambda x: np.sin(x[0]) + 7.0 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0]),
        n=2**14,
        dists=[angle] * 3,
        rng=np.random.default_rng(1),
    )
    assert found.first_order == pytest.approx([0.313905, 0.442411, 0.0], abs=0.01)
    assert found.total_order[[0, 2]] == pytest.approx([0.557589, 0.243684], abs=0.01)
