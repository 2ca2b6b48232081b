"""The laws of contact: values, stored energy, and that a record has no constants of other laws."""

import numpy as np
import pytest
from scipy.integrate import quad

from tests.scenes.support import CONTACT, small
from tipoff.mechanics.laws import contact
from tipoff.scenes import parse

HUNT = {
    "law": "hunt-crossley",
    "clearance": "0.1 mm",
    "stiffness": "70000 N/mm**1.5",
    "dissipation": "0.2 s/m",
}
LINEAR = {"law": "linear", "clearance": "0.1 mm", "stiffness": "1e4 N/mm", "damping": "60 N*s/m"}
TABLES = [CONTACT, CONTACT | {"exponent": 2.2, "stiffness": "5e5 N/mm**2.2"}, HUNT, LINEAR]


def record(table):
    return parse(small(contact=table)).contact.record()


@pytest.mark.parametrize("table", TABLES)
def test_stored_energy_is_the_integral_of_the_elastic_force(table):
    law = record(table)
    for depth in (1e-6, 2e-5, 1e-3):
        integral, _ = quad(
            lambda p: contact.parts(law, p, 0.0)[0], 0.0, depth, epsabs=0.0, epsrel=1e-12
        )
        assert contact.stored_energy(law, depth) == pytest.approx(integral, rel=1e-10)


@pytest.mark.parametrize("table", TABLES)
def test_damping_resists(table):
    """It pushes while closing, pulls back while opening, by the same amount, and is absent at
    rest."""
    law = record(table)
    closing, opening, rest = (contact.parts(law, 1e-4, speed)[1] for speed in (0.1, -0.1, 0.0))
    assert closing == -opening > 0.0 == rest


def test_impact_values():
    """70000 N/mm^1.5 at 0.04 mm is 70000 x 0.008 = 560 N; at half of d the step is half done, 30 N
    s/mm at 2 mm/s is 60 N."""
    law = record(CONTACT)
    assert contact.parts(law, 4e-5, 0.0)[0] == pytest.approx(560.0, rel=1e-12)
    assert contact.parts(law, 1.5e-4, 2e-3)[1] == pytest.approx(60.0, rel=1e-12)
    assert contact.parts(law, 3e-4, 2e-3)[1] == pytest.approx(120.0, rel=1e-12)
    assert contact.parts(law, 3e-2, 2e-3)[1] == pytest.approx(120.0, rel=1e-12)


def test_hunt_crossley_and_linear_values():
    assert contact.parts(record(HUNT), 4e-5, 0.5) == pytest.approx((560.0, 56.0), rel=1e-12)
    assert contact.parts(record(LINEAR), 1e-5, 0.5) == pytest.approx((100.0, 30.0), rel=1e-12)


def test_the_shortcut_for_hertz_is_the_power():
    law = record(CONTACT)
    depths = np.geomspace(1e-9, 1e-2, 50)
    found = [contact.parts(law, depth, 0.0)[0] for depth in depths]
    assert np.allclose(found, law.stiffness * depths**1.5, rtol=1e-15)


def test_constants_of_other_laws_are_absent():
    names = {
        "impact": {"stiffness", "exponent", "damping", "damping_depth"},
        "hunt-crossley": {"stiffness", "exponent", "dissipation"},
        "linear": {"stiffness", "damping"},
    }
    for table in TABLES:
        found, absent = record(table)._asdict(), contact.NO_CONTACT._asdict()
        assert {name for name in found if found[name] != absent[name]} == names[table["law"]]
