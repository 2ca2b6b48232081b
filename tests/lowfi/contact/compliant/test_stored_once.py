"""Blocks between two faces that are stored for one order only, as on a long rail."""

from dataclasses import replace

import numpy as np
import pytest

from tests.lowfi.compliance import (
    POSES,
    REFERENCE,
    pose_of,
    pressed,
    reference_compliance,
    seen_from_platform,
    solved,
    state_of,
)
from tipoff.lowfi.contact.compliant import solution
from tipoff.mechanics.rail_compliance import pairs, splines

FACES = {"over the rail": "all faces of a rail, tilted", "over its end": "rear pads over the end"}


def of(walls, pose: str, turned: bool = True) -> tuple[np.ndarray, ...]:
    """Flexibility and slope between the faces of each rail, forces, and the wall under a face that only
    follows the others, with friction."""
    model, system = pressed(REFERENCE, walls, modes=2)
    if not turned:
        compliance = system.compliance
        system = system._replace(
            compliance=compliance._replace(turned=np.zeros_like(compliance.turned))
        )
    compliance, at = system.compliance, pose_of(model, pose)
    work, found = compliance.workspace, []
    modes = np.zeros(2 * compliance.modes.square.size)
    state = np.append(state_of(model, at), modes)
    place, _ = seen_from_platform(system.platform, system.payload, state)
    for rail, members in enumerate(compliance.members):
        count = solved(system, model, at, rail, modes=modes)
        found += [work.flexibility[:count, :count].copy(), work.slope[:count, :count].copy()]
        found.append(work.force[members].copy())
        for face in members:
            followed = np.zeros(work.force.shape[1])
            solution.follow(compliance, face, place[0] + system.faces[0, 0], count, state, followed)
            found.append(followed)
    return tuple(found)


def differences(one, other) -> np.ndarray:
    """Largest difference of each part, relative to its largest value."""
    return np.array(
        [np.abs(a - b).max() / max(np.abs(b).max(), 1e-30) for a, b in zip(one, other, strict=True)]
    )


@pytest.mark.parametrize("pose", FACES.values(), ids=FACES)
def test_faces_meet_what_blocks_for_both_orders_give(monkeypatch, pose):
    """To rounding. Control: blocks of the other order that are not transposed."""
    assert pose in POSES
    walls = reference_compliance()
    expected = of(walls, pose)
    monkeypatch.setattr(splines, "LARGE", 0.0)
    once, faces = replace(walls), walls.members.shape[1]
    stored, both = once.cubic(2)[0], walls.cubic(2)[0]
    assert 2 * faces * stored.shape[1] == (faces + 1) * both.shape[1]
    assert differences(of(once, pose), expected).max() < 1e-9
    wrong = differences(of(once, pose, turned=False), expected)
    assert (wrong[:2] > 1e-3).all()


@pytest.mark.parametrize("once", [False, True])
def test_blocks_are_numbered_by_pairs(once):
    """A rail with three faces and one with one."""
    rail = np.array([0, 1, 0, 0])
    number, turned = pairs.numbered(rail, once)
    near = pairs.beside(rail)
    assert ((number >= 0) == (near >= 0)).all() and turned.any() == once
    assert sorted(number[(number >= 0) & ~turned]) == list(range(7 if once else 10))
    for face, place in np.argwhere(turned):
        other = near[face, place]
        assert other < face and number[face, place] == number[other, near[other] == face][0]
