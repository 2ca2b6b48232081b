"""The law fitted to its own data: what is there is found, what is not there is named."""

import numpy as np
import pytest

from tipoff.calibration import law_fit
from tipoff.scenes.effects.contact import Impact

# The paper pad: k 70 000 N/mm^1.5, c 60 N s/mm, d 0.30 mm (paper, Table 2), e 1.5; friction 0.2.
PAD = Impact(70_000 * 1e3**1.5, 1.5, 60e3, 0.3e-3)
MU = 0.2


def bench(deepest: float, samples: int = 400) -> tuple[np.ndarray, ...]:
    """Penetration, rate, normal and tangential force of the pad by the formula of IMPACT in plain
    NumPy, some of it pulling back."""
    p = deepest * np.linspace(0.01, 1.0, samples)
    q = 0.05 * np.cos(np.linspace(0.0, 40.0, samples))
    x = np.minimum(p / PAD.damping_depth, 1.0)
    normal = np.maximum(
        0.0, PAD.stiffness * p**PAD.exponent + PAD.damping * x**2 * (3.0 - 2.0 * x) * q
    )
    return p, q, normal, MU * normal


@pytest.mark.case("O42")
@pytest.mark.parametrize("off", [0.7, 1.3])
def test_recovers_the_paper_pad(off):
    """F = k p^e + c s(p/d) q with p to 0.4 mm, beyond d: c and d are told apart. 1e-5 relative;
    rounding leaves 1e-10."""
    start = Impact(
        PAD.stiffness * off, PAD.exponent * off, PAD.damping / off, PAD.damping_depth * off
    )
    found = law_fit.fit(*bench(0.4e-3), start)
    np.testing.assert_allclose(found.law, PAD, rtol=1e-5)
    assert found.friction == pytest.approx(MU, rel=1e-5)
    assert found.weak_directions == []


def test_shallow_data_cannot_tell_damping_from_its_depth():
    """To 0.01 mm the law is c (p/d)^2 (3 - 2 p/d) q with p/d below 1/30: the curves hold c/d^2, and
    the report must say so."""
    start = Impact(PAD.stiffness * 0.9, PAD.exponent, PAD.damping * 1.2, PAD.damping_depth)
    found = law_fit.fit(*bench(0.01e-3), start)
    weakest = found.weak_directions[0]
    assert "contact.damping " in weakest and "contact.damping_depth" in weakest
    # c/d^2 stays constant along d(ln c) = 2 d(ln d).
    _, vectors = np.linalg.eigh(found.information)
    assert vectors[2, 0] / vectors[3, 0] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda d: (d[0][:3], *d[1:]),
        lambda d: tuple(c[:3] for c in d),
        lambda d: (d[0], d[1], d[2] * np.nan, d[3]),
        lambda d: (-d[0], *d[1:]),
    ],
)
def test_refuses_samples_that_say_nothing(spoil):
    with pytest.raises(ValueError, match="samples"):
        law_fit.fit(*spoil(bench(0.4e-3)), PAD)
