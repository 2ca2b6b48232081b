"""Tables between the faces on one rail, against those between all faces."""

import numpy as np
import pytest

from tipoff.mechanics.rail_compliance import pairs

RAIL = np.array([1, 0, 0, 1, -1, 2, 1])  # of seven faces; one is on none


@pytest.fixture
def every():
    """Between all faces, and nothing between different rails."""
    random = np.random.default_rng(3).standard_normal((5, 7, 2, 7, 3))
    together = (RAIL[:, None] == RAIL) & (RAIL >= 0)
    return random * together[:, None, :, None]


def test_faces_on_each_rail():
    assert pairs.members(RAIL).tolist() == [[1, 2, -1], [0, 3, 6], [5, -1, -1]]
    assert pairs.beside(RAIL)[[0, 4, 5]].tolist() == [[0, 3, 6], [-1, -1, -1], [5, -1, -1]]


def test_a_table_of_all_faces_and_back(every):
    near = pairs.of_whole(every, RAIL)
    assert near.shape == (5, 7, 3, 2, 3)
    np.testing.assert_array_equal(pairs.whole(near, RAIL), every)


def test_the_transposed_table(every):
    turned = pairs.transposed(pairs.of_whole(every, RAIL), RAIL)
    np.testing.assert_array_equal(pairs.whole(turned, RAIL), every.transpose(0, 3, 4, 1, 2))


def test_the_matrix_of_a_rail_and_back(every):
    near, own = pairs.of_whole(every, RAIL), np.array([0, 3, 6])
    matrix = pairs.of_rail(near, own)
    wanted = every[:, own][:, :, :, own].reshape(5, 6, 9)
    np.testing.assert_array_equal(matrix, wanted)
    np.testing.assert_array_equal(pairs.blocks(matrix, own.size), near[:, own])


def test_matrices_on_both_sides(every):
    square = every[..., :2]
    each = np.random.default_rng(4).standard_normal((5, 7, 4, 2))
    found = pairs.on_both_sides(each, pairs.of_whole(square, RAIL), RAIL)
    wanted = np.einsum("siab,sibjc,sjdc->siajd", each, square, each)
    assert pairs.whole(found, RAIL) == pytest.approx(wanted, rel=1e-12, abs=1e-12)
