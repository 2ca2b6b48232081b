"""The search for the largest certified scale: steps at a given scale, every state without a result,
and counts that do not grow."""

import pytest

from tipoff.studies.limits.search import ALL, FOUND, NONE, SMALL, largest, near


def step(place, below=0, beyond=10):
    return lambda scale: below if scale <= place else beyond


@pytest.mark.parametrize("place", [0.009, 0.1234, 0.5, 0.77])
def test_a_step_is_found_from_below(place):
    for found, finest in (
        (largest(step(place), 3), 2.0 ** (1 / 64)),
        (near(step(place), 3, 0.3), 1.25 ** (1 / 8)),
    ):
        assert (
            found.state == FOUND
            and found.tolerance <= place < found.fails
            and found.fails / found.tolerance <= finest * (1.0 + 1e-12)
        )
        assert not found.falls and not found.again


@pytest.mark.parametrize(
    "search", [lambda above: largest(above, 3), lambda above: near(above, 3, 0.2)]
)
def test_searches_without_a_result_have_different_states(search):
    assert search(step(2.0)).state == ALL and search(step(2.0)).tolerance == 1.0
    assert search(step(1e-4)).state == SMALL and search(step(1e-4)).tolerance is None
    assert search(step(2.0, below=4)).state == NONE and search(step(2.0, below=4)).tolerance is None


def test_a_certified_scale_beyond_a_failure_is_reported_and_not_used():
    """The scales between 0.1 and 0.3 fail, 0.5 and 1 pass; the result is below 0.1."""
    found = largest(lambda scale: 9 if 0.1 < scale <= 0.3 else 2, 3)
    assert found.state == FOUND and found.tolerance <= 0.1 < found.fails
    assert found.again == (0.5, 1.0) and [pair[1] for pair in found.falls] == [0.5]


def test_each_scale_is_counted_once():
    scales = []
    largest(lambda scale: scales.append(scale) or int(scale > 0.4), 0)
    assert len(scales) == len(set(scales)) == 14
