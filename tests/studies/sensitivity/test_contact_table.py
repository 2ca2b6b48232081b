"""The table of contact constants: the changes of a scene, and their deviations."""

import numpy as np
import pytest

from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes import load
from tipoff.studies.sensitivity import contact_table
from tipoff.studies.sensitivity.contact_table import Deviations


def test_a_rate_that_is_nearly_zero_has_no_relative_deviation():
    """0.042 deg/s, so that 0.003 deg/s would be 7 %. Control: the other axes have one."""
    found = contact_table.deviations([-2.655, -3.621, 0.042], [-2.665, -3.628, 0.045])
    assert found.relative[2] is None and None not in found.relative[:2]
    assert found.absolute_deg_s[2] == pytest.approx(0.003)
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
