"""Walls that are not straight as drawn, on compliant contact: one potential of all forces, and an
offset that is the same everywhere is another clearance; the step limit with their slopes."""

from dataclasses import replace

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, SMOOTH, pressed, reference_compliance
from tests.lowfi.contact.compliant.test_statics import (
    BASES,
    POSES,
    derivative,
    energy,
    generalised,
    limits,
    pose_of,
    spectrum,
)
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import cells
from tipoff.lowfi.faces import WALL
from tipoff.mechanics import drawn_walls
from tipoff.scenes import scene_model

PLACES = drawn_walls.grid(REFERENCE.rail.start, REFERENCE.rail.end)


def with_offset(offset):
    """The compliance of the reference scene, its walls drawn with ``offset`` (n,3) m on all faces."""
    flexible = reference_compliance()
    return replace(flexible, drawn=np.repeat(offset[:, None], flexible.rail.size, axis=1))


def curved():
    """A draft, a bow and a twist of some micrometres, steep enough to be seen."""
    x = (PLACES - PLACES[0]) / (PLACES[-1] - PLACES[0])
    return 1e-6 * np.column_stack([40.0 * np.sin(3.0 * x) - 20.0, 20.0 * x, 5.0 * np.cos(4.0 * x)])


@pytest.mark.parametrize("name", ["all faces of a rail, tilted", "rear pads over the end"])
def test_forces_are_the_gradient_of_the_energy(name):
    compliance = with_offset(curved())
    model, system = pressed(REFERENCE.replace(SMOOTH), compliance)
    pose, h, twists = pose_of(model, name, BASES["moved and turned"]), 1e-9, np.eye(12)
    out = [derivative(system, model, pose, twist) for twist in twists]
    forces, released = generalised(pose, out[0]), np.array([each[slot.RELEASED] for each in out])
    slopes = np.array(
        [
            (
                energy(system, model, pose.moved(twist, h))
                - energy(system, model, pose.moved(twist, -h))
            )
            / (2.0 * h)
            for twist in twists
        ]
    )
    size = np.abs(forces).max()
    assert size > 20.0 and slopes == pytest.approx(-forces - released, abs=1e-7 * size, rel=0.0)
    # Control: what the slopes of the walls push is far above that.
    pushed = [
        np.abs(cells.push_of_drawn_slopes(system.compliance, face)).max()
        for face in range(len(system.faces))
    ]
    assert max(pushed) > 1e-5 * size


def test_a_constant_offset_is_another_clearance():
    """Energy and forces of a pose, to rounding. Control: without the offset they differ."""
    away, flat = 13e-6, np.zeros((PLACES.size, 3))
    name, twist = "all faces of a rail, tilted", np.zeros(12)
    flat[:, 0] = away

    def answer(compliance, moved):
        model, system = pressed(REFERENCE.replace(SMOOTH), compliance)
        pose = pose_of(
            scene_model.build(REFERENCE.replace(SMOOTH)), name, BASES["moved and turned"]
        )
        system.faces[:, WALL] += moved
        return energy(system, model, pose), derivative(system, model, pose, twist)

    shifted, drawn = answer(reference_compliance(), away), answer(with_offset(flat), 0.0)
    plain = answer(reference_compliance(), 0.0)
    assert drawn[0] == pytest.approx(shifted[0], rel=1e-12)
    assert drawn[1] == pytest.approx(shifted[1], rel=1e-11, abs=1e-12 * np.abs(shifted[1]).max())
    assert abs(plain[0] / shifted[0] - 1.0) > 1e-3


STEEP, HALF, TOUCH = np.tan(np.radians(4.9)), 8e-3, 0.85  # slope, half a pad (m), where it touches
SHAPES = {
    "draft": lambda x: (STEEP * (x + TOUCH * HALF), 0.0),
    "tilt": lambda x: (STEEP * TOUCH * HALF, STEEP * HALF),
    "draft and tilt": lambda x: (STEEP * (x + 2.0 * TOUCH * HALF), STEEP * HALF),
    "bow": lambda x: (0.5 * STEEP / HALF * x * x, 0.0),
    "twist": lambda x: (STEEP * TOUCH**2 * HALF, STEEP * x),
    "ramp": lambda x: (STEEP * np.maximum(x, 0.0), 0.0),
}


def pressed_alone(shape, travel):
    """Model and records with walls of a ``shape`` around the middle of each face after ``travel`` (m),
    those of all but one face on the first leg 1 mm farther away."""
    model, flexible, face = scene_model.build(REFERENCE), reference_compliance(), 12
    middle = model.payload.mass_centre[0] - model.platform.mass_centre[0] + travel
    places = drawn_walls.grid(model.rail_start, model.rail_end)
    drawn = np.full((places.size, flexible.rail.size, 3), 1e-3)
    for column, values in enumerate((*shape(places - model.faces.centre[face, 0] - middle), 0.0)):
        drawn[:, face, column] = values
    return pressed(REFERENCE.replace(SMOOTH), replace(flexible, drawn=drawn))


@pytest.mark.parametrize("name", SHAPES)
def test_step_limit_bounds_the_spectrum_on_slopes(name):
    """One pad presses, so the trace is hardly more than the largest eigenvalue, and a bound without
    slopes is not above it. Where the slope is not linear under the pad the bound is wider."""
    model, system = pressed_alone(SHAPES[name], POSES["one leg"][0])
    pose = pose_of(model, "one leg", BASES["moved and turned"])
    fastest = np.abs(np.linalg.eigvals(spectrum(system, model, pose))).max()
    springs = limits(system, model, pose)[0]
    assert fastest > 1e5
    assert fastest < springs < (1.3 if name == "ramp" else 1.01) * fastest
