"""The printed tables of the paper, and their arithmetic."""

import numpy as np
import pytest

from validation import published


def test_largest_deviations_of_the_paper():
    """By hand from Table 2: x, condition 2, d 0.25; y, condition 4, d 0.25; z, condition 4, c 50.
    The text of the paper gives 0.26 % for z, which is that of d 0.35."""
    table = published.sensitivity()
    shares = table.largest_relative()
    by_hand = [(2.421 - 2.355) / 2.421, (1.633 - 1.609) / 1.633, (2.663 - 2.644) / 2.663]
    assert shares == pytest.approx(by_hand, rel=1e-9)
    assert np.round(100.0 * shares, 2).tolist() == [2.73, 1.47, 0.71]
    assert abs(table.deviations()).max(axis=(0, 1)) == pytest.approx(
        [5.341 - 5.254, 2.588 - 2.554, 2.663 - 2.644], rel=1e-9
    )
    in_text = table.deviations()[2, 5, 2] / table.baseline[2, 2]
    assert round(100.0 * in_text, 2) == 0.26
