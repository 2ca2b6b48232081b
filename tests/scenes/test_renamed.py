"""A key under its former name is refused with the name that it has now."""

import pytest

from tests.scenes.support import CONTACT, refused, small
from tipoff.scenes import SceneError, parse, uncertainty
from tipoff.scenes.variation import Variations

EXPECTED = "the key contact.interface_stiffness, with the same value and unit"


def test_in_a_file_beside_every_other_fault():
    """In the table, in a condition and in the provenance."""
    faults = refused(
        small(
            contact={**CONTACT, "penalty": "1e12 N/m**3"},
            payload__mass="0 kg",
            conditions={"stiff": {"contact.penalty": "4e12 N/m**3"}},
            provenance={"contact.penalty": "measured"},
        )
    )
    old = [fault for fault in faults if fault.key.endswith("contact.penalty")]
    assert [fault.key for fault in old] == [
        "contact.penalty",
        "conditions.stiff.contact.penalty",
        "provenance.contact.penalty",
    ]
    assert {fault.expected for fault in old} == {EXPECTED}
    assert "payload.mass" in [fault.key for fault in faults]


def test_as_an_override_and_as_an_input_that_varies():
    """Control: the new name passes."""
    scene = parse(small(contact=dict(CONTACT)))
    for change in (scene.replace, Variations(scene).of):
        with pytest.raises(SceneError, match=EXPECTED):
            change({"contact.penalty": "1e12 N/m**3"})
        new = change({"contact.interface_stiffness": "1e12 N/m**3"})
        assert new.contact.interface_stiffness == 1e12
    vary = {"distribution": "uniform", "low": "1e12 N/m**3", "high": "2e12 N/m**3"}
    with pytest.raises(SceneError, match=EXPECTED):
        uncertainty.parse({"cases": 1, "vary": {"contact.penalty": vary}}, scene, "file.toml")
