"""Records made from a scene: None where an effect is absent, places where the scene puts them."""

import numpy as np
import pytest

from tests.scenes.support import CONTACT, FRICTION, small
from tipoff.mechanics.laws.body_force import BodyForce, acceleration
from tipoff.mechanics.laws.initial import Initial
from tipoff.scenes import load, parse, scene_model

PLATFORM = {
    "mass": "80 kg",
    "inertia": {"xx": "4 kg*m**2", "yy": "5 kg*m**2", "zz": "6 kg*m**2"},
    "mass_centre": {"x": "-0.1 m"},
}
WHOLE = dict(
    contact=CONTACT,
    friction=FRICTION,
    platform=PLATFORM,
    gravity={"z": "-9.81 m/s**2"},
    initial={"position": {"y": "20 um"}},
    thrust_offset={"misalignment": {"axial": "1 deg"}},
    mass_offset={"eccentricity": {"axial": "1 mm", "radial": "90 deg"}},
)
RECORDS = {
    "contact": ("contact", "interface_stiffness"),
    "friction": ("friction",),
    "platform": ("platform",),
    "gravity": ("body_force",),
}


def test_every_effect_absent_is_none():
    found = scene_model.build(parse(small()))
    for name in (
        "thrust_offset",
        "contact",
        "interface_stiffness",
        "friction",
        "platform",
        "body_force",
    ):
        assert getattr(found, name) is None, name
    assert found.initial == Initial()
    assert found.initial == Initial(*[(0.0, 0.0, 0.0)] * 6)


def test_every_effect_present_is_a_record():
    found = scene_model.build(parse(small(**WHOLE)))
    assert None not in (
        found.thrust_offset,
        found.contact,
        found.interface_stiffness,
        found.friction,
        found.platform,
        found.fall,
    )
    assert found.body_force is None  # a free platform falls with the payload


@pytest.mark.parametrize("effect", RECORDS)
def test_an_effect_removed_is_none_again(effect):
    found = scene_model.build(parse(small(**WHOLE)).replace({effect: None}))
    assert all(getattr(found, name) is None for name in RECORDS[effect])


def test_thrust_is_offset_by_either_table():
    scene = parse(small(**WHOLE))
    assert scene_model.build(scene.replace({"thrust_offset": None})).thrust_offset is not None
    assert scene_model.build(scene.replace({"mass_offset": None})).thrust_offset is not None
    assert (
        scene_model.build(scene.replace({"mass_offset": None, "thrust_offset": None})).thrust_offset
        is None
    )


def test_friction_needs_contact():
    assert scene_model.build(parse(small(friction=FRICTION))).friction is None


def test_no_body_force_accelerates_nothing():
    assert acceleration(None) == (0.0, 0.0, 0.0)
    assert acceleration(BodyForce(1.0, 2.0, 3.0)) == (1.0, 2.0, 3.0)


def test_line_of_action():
    """Misalignment from +X, clock angle from +Y to +Z; l_y = r sin, l_z = r cos; arms about the
    actual mass centre."""
    offset = {
        "misalignment": {"axial": "30 deg", "radial": "90 deg"},
        "eccentricity": {"axial": "3 mm", "radial": "90 deg"},
    }
    found = scene_model.build(
        parse(
            small(
                thrust_offset=offset,
                mass_offset={"eccentricity": {"axial": "1 mm", "radial": "0 deg"}},
            )
        )
    ).thrust_offset
    assert found.direction == pytest.approx((np.sqrt(0.75), 0.0, 0.5), abs=1e-15)
    assert found.arm == pytest.approx((-0.1, 3e-3, -1e-3), abs=1e-15)


def test_faces_and_walls():
    """A corner at (y, z) = (0.1, 0.1): the y face lies inset towards the axis along z, its wall a
    clearance outside."""
    raw = small(
        contact=CONTACT,
        platform=PLATFORM,
        mass_offset={"eccentricity": {"axial": "1 mm", "radial": "90 deg"}},
    )
    raw["pads"][0]["inset"] = "9 mm"
    found = scene_model.build(parse(raw))
    assert found.faces.centre == pytest.approx(np.array([[0.0, 0.099, 0.091], [0.0, 0.090, 0.1]]))
    assert found.faces.axis.tolist() == [1, 2]
    assert found.faces.sign.tolist() == [1.0, 1.0]
    assert found.faces.wall == pytest.approx([0.1001, 0.1001])
    assert (found.rail_start, found.rail_end) == pytest.approx((0.0, 0.2))
    assert found.payload.mass_centre == pytest.approx((0.0, 1e-3, 0.0))


def test_the_gap_is_the_clearance_on_every_face_of_the_reference():
    found = scene_model.build(load("reference"))
    faces = found.faces
    gap = faces.sign * (
        faces.wall + found.platform.mass_centre[1] - faces.centre[np.arange(16), faces.axis]
    )
    assert gap == pytest.approx(np.full(16, 0.25e-3), rel=1e-12)
    assert np.bincount(faces.pad).tolist() == [2] * 8


def test_inverse_inertia():
    payload = scene_model.build(load("reference")).payload
    assert np.allclose(payload.inertia @ payload.inverse_inertia, np.eye(3), atol=1e-15)
    assert payload.inertia[0, 1] == payload.inertia[1, 0] == 0.004
