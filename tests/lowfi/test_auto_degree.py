"""The degree of patterns that a run chooses."""

from types import SimpleNamespace

import numpy as np
import pytest

import tipoff
from tests.highfi.support import COARSE, tiny
from tipoff import highfi, lowfi
from tipoff.lowfi import degrees, modes
from tipoff.lowfi.ensemble.batch import Family
from tipoff.scenes import SceneError
from tipoff.workspace import asked


@pytest.fixture(scope="module")
def fourth():
    return highfi.condense(tiny(), COARSE.element_size, degree=4)


def rate_of(compliance, **numerics) -> np.ndarray:
    found = lowfi.run(tiny(), compliance=compliance, numerics=lowfi.Numerics(modes=0, **numerics))
    return np.array(found.outcome.rate)


FIFTEEN_PATTERNS = pytest.mark.slow  # a kernel of their own


@pytest.mark.parametrize(
    "highest, limit, expected",
    [
        (3, 1e-3, 2),
        (3, 1e-5, 3),
        pytest.param(4, 1e-4, 3, marks=FIFTEEN_PATTERNS),
        pytest.param(4, 1e-5, 4, marks=FIFTEEN_PATTERNS),
    ],
)
def test_it_is_the_least_whose_next_hardly_changes_the_rates(
    fourth, monkeypatch, highest, limit, expected
):
    """For limits (rad/s) that degrees meet or not. The run has the bits of a run with its degree."""
    monkeypatch.setattr(degrees, "THRESHOLD", limit)
    compliance = fourth.of_degree(highest)
    rates = {degree: rate_of(compliance, degree=degree) for degree in range(2, highest + 1)}
    changes = {each: np.abs(rates[each + 1] - rates[each]).max() for each in range(2, highest)}
    least = next((each for each, change in changes.items() if change <= limit), highest)
    assert least == expected
    numerics = lowfi.Numerics(modes=0, degree="auto")
    found = lowfi.run(tiny(), compliance=compliance, numerics=numerics)
    assert found.numerics["degree"] == expected
    assert found.numerics["degree_why"].startswith(f"{expected}: ")
    np.testing.assert_array_equal(found.outcome.rate, rates[expected])


def test_its_limit_is_that_of_modes():
    assert degrees.THRESHOLD == modes.THRESHOLD


def test_no_higher_degree_than_that_of_the_compliance(fourth):
    second = fourth.of_degree(2)
    found = lowfi.run(tiny(), compliance=second, numerics=lowfi.Numerics(modes=0, degree="auto"))
    assert found.numerics["degree"] == 2 and "no higher one" in found.numerics["degree_why"]


def test_where_it_has_no_meaning(fourth):
    """Springs have no patterns, and the cases of an ensemble have one number. Without contact nothing is
    chosen."""
    numerics = lowfi.Numerics(modes=0, degree="auto")
    with pytest.raises(SceneError, match="numerics.degree: given auto"):
        lowfi.run(tiny(), "springs", numerics=numerics)
    with pytest.raises(ValueError, match="degree: cases of an ensemble need a number"):
        Family(tiny(), None, numerics, fourth)
    free = lowfi.run(tiny().replace({"contact": None, "friction": None}), numerics=numerics)
    assert "degree_why" not in free.numerics
    with pytest.raises(ValueError, match="1 to 5, or 'auto'"):
        lowfi.Numerics(degree="most")


def test_springs_have_no_cells():
    """Control: the default."""
    with pytest.raises(SceneError, match="numerics.cells: given 8, expected none"):
        lowfi.run(tiny(), "springs", numerics=lowfi.Numerics(cells=8))
    lowfi.run(tiny(), "springs", numerics=lowfi.Numerics())


def test_a_call_from_python_may_choose_it(monkeypatch):
    """As the command line does."""
    monkeypatch.setattr(asked, "compliance", lambda _, size, degree: given.append(degree) or walls)
    given, walls = [], highfi.condense(tiny(), COARSE.element_size)
    found = tipoff.run(tiny(), modes=0, degree="auto")
    assert given == [5] and found.numerics["degree"] in (2, 3)


@pytest.mark.parametrize("lost", [2, 3])
def test_a_run_that_does_not_settle_leaves_the_default(lost):
    """The reason names its degree. Control: the others settle."""

    def run(degree):
        rate = None if degree == lost else [0.0, 0.0, float(degree)]
        return SimpleNamespace(message="", judged=lambda: ("", SimpleNamespace(rate=rate)))

    found, why = degrees.choose(run, 4)
    assert found == 3 and f"patterns of degree {lost} did not settle" in why
    assert degrees.choose(lambda degree: run(1), 4)[0] == 2


def test_an_ensemble_has_one_degree():
    """It was refused after the pilot, with words about modes."""
    with pytest.raises(
        ValueError, match="^degree: given 'auto', expected the number that all cases"
    ):
        tipoff.ensemble(tiny(), "paper", count=2, degree="auto")
