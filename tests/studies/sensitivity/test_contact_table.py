"""The table of contact constants: the deviations of the paper from its rates, and the changes of a
scene."""

import numpy as np
import pytest

from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes import load
from tipoff.studies import published
from tipoff.studies.sensitivity import contact_table
from tipoff.studies.sensitivity.contact_table import Deviations


def test_largest_deviations_of_the_paper():
    """By hand from Table 2: x, condition 2, d 0.25; y, condition 4, d 0.25; z, condition 4, c 50.
    The text of the paper gives 0.26 % for z, which is that of d 0.35."""
    table = contact_table.of_paper()
    assert len(table) == 21 and [row.condition for row in table[::7]] == list(published.CONDITIONS)
    found = contact_table.largest(table)
    assert found.relative == pytest.approx(
        [(2.421 - 2.355) / 2.421, (1.633 - 1.609) / 1.633, (2.663 - 2.644) / 2.663], rel=1e-9
    )
    assert [round(100.0 * share, 2) for share in found.relative] == [2.73, 1.47, 0.71]
    assert found.absolute_deg_s == pytest.approx(
        [5.341 - 5.254, 2.588 - 2.554, 2.663 - 2.644], rel=1e-9
    )
    in_text = next(
        row for row in table if (row.condition, row.symbol, row.raised) == ("phi60", "d", True)
    )
    assert round(100.0 * in_text.relative[2], 2) == 0.26


def test_a_rate_that_is_nearly_zero_has_no_relative_deviation():
    """Condition 3 of the paper about z: 0.042 deg/s, so that 0.003 deg/s would be 7 %."""
    row = next(
        row
        for row in contact_table.of_paper()
        if (row.condition, row.symbol, row.raised) == ("phi35", "c", False)
    )
    assert (
        row.relative[2] is None
        and row.relative[0] is not None
        and row.absolute_deg_s[2] == pytest.approx(0.003)
    )
    assert contact_table.deviations([0.0] * 3, [0.0, 0.1, 0.0]) == Deviations(
        absolute_deg_s=(0.0, 0.1, 0.0), relative=(None, None, None)
    )


@pytest.mark.parametrize(
    "law, symbols",
    [
        ({}, ["k", "c", "d"]),
        (
            {"contact": {"law": "linear", "stiffness": 1e7, "damping": 10.0, "clearance": 2e-4}},
            ["k", "c"],
        ),
        (
            {
                "contact": {
                    "law": "hunt-crossley",
                    "stiffness": 1e9,
                    "dissipation": 0.3,
                    "clearance": 2e-4,
                }
            },
            ["k", "a"],
        ),
    ],
)
def test_the_constants_of_a_law_are_lowered_and_raised(law, symbols):
    scene = load("reference").replace(law)
    found = contact_table.changes(scene, SPRINGS)
    assert [item.symbol for item in found] == [
        "baseline",
        *(symbol for symbol in symbols for _ in "du"),
        "clearance",
    ]
    down, up = (
        item.overrides["contact.stiffness"] / scene.contact.stiffness for item in found[1:3]
    )
    assert (down, up) == pytest.approx((66.0 / 70.0, 74.0 / 70.0))
    assert found[-1].overrides["contact.clearance"] - scene.contact.clearance == pytest.approx(1e-6)
    assert [item.symbol for item in contact_table.changes(scene, COMPLIANT)] == [
        "baseline",
        "interface stiffness",
        "interface stiffness",
        "clearance",
    ]


def test_clearances_along_the_axes_grow_together():
    axes = {"contact.clearance_y": 1e-4, "contact.clearance_z": 2e-4}
    last = contact_table.changes(load("reference").replace(axes), COMPLIANT)[-1]
    assert last.overrides == pytest.approx({key: gap + 1e-6 for key, gap in axes.items()})
    assert last.share == pytest.approx(0.01)


def test_a_case_that_did_not_settle_is_not_counted():
    scene = load("reference")
    changed = contact_table.changes(scene, COMPLIANT)
    rates = np.array([[1.0, 1.0, 1.0], [1.1, 1.0, 1.0], [np.nan] * 3, [1.0, 1.0, 0.9]])
    table = contact_table.rows("phi15", changed, rates)
    assert table[2].rate_deg_s is None and contact_table.largest(
        table
    ).absolute_deg_s == pytest.approx([0.1, 0.0, 0.0])
    assert contact_table.largest(table, ["clearance"]).relative == pytest.approx([0.0, 0.0, 0.1])
