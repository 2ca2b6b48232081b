"""Neighbours within 1 um of a condition: where they lie, and that both models have the same ones."""

import math

import numpy as np
import pytest

from tipoff.scenes import load
from tipoff.studies.agreement import neighbours

UM = 1e-6


def columns(scene, cases=400, distance=UM):
    rows = neighbours.draw(scene, distance, cases)
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}


def test_no_draw_moves_a_pad_by_more_than_the_distance():
    """Each cause alone moves the farthest pad by up to 1 um: the walls, the position, and the turn by
    the exact displacement |R r - r| = 2 r sin(angle / 2). Control: the sum of the causes goes
    farther, so none is bounded by another."""
    scene = load("reference")
    found = columns(scene)
    gap = found["contact.clearance"] - scene.contact.clearance
    places = np.array([pad.position for pad in scene.pads])
    moved = [np.abs(gap), *(np.abs(found[f"initial.position.{axis}"]) for axis in "yz")]
    for place, axis in enumerate("xyz"):
        radius = np.linalg.norm(np.delete(places, place, axis=1), axis=1).max()
        angle = np.abs(found[f"initial.attitude.{axis}"])
        moved.append(2.0 * radius * np.sin(0.5 * angle))
    for values in moved:
        assert 0.98 * UM < values.max() <= UM * (1.0 + 1e-9)
        # uniform: mean of |u| is d / 2, with a standard error of d / sqrt(12 n)
        assert values.mean() == pytest.approx(0.5 * UM, abs=4.0 * UM / math.sqrt(12.0 * 400))
    assert np.sum(moved, axis=0).max() > 3.0 * UM


def test_the_draws_are_independent():
    """Correlations of 400 independent draws have a standard deviation of 0.05."""
    found = np.corrcoef(list(columns(load("reference")).values()))
    assert np.abs(found - np.eye(6)).max() < 0.2


def test_a_case_is_the_same_however_many_are_drawn():
    scene = load("reference").condition("h8")
    assert neighbours.draw(scene, UM, 40)[:7] == neighbours.draw(scene, UM, 7)


def test_neighbours_stay_beside_the_initial_state_of_the_condition():
    """Control: a condition that begins in the middle."""
    off = columns(load("reference").condition("h10"))["initial.position.y"]
    middle = columns(load("reference").condition("h9"))["initial.position.y"]
    assert np.abs(off - 20e-6).max() <= UM * (1.0 + 1e-9)
    assert off == pytest.approx(20e-6 + middle, abs=1e-18)
    assert np.abs(middle).max() <= UM


def test_each_clearance_moves_where_the_walls_have_their_own():
    scene = load("reference").replace({"contact.clearance_y": "0.3 mm"})
    found = columns(scene, 20)
    shift = found["contact.clearance"] - scene.contact.clearance
    assert found["contact.clearance_y"] - 0.3e-3 == pytest.approx(shift, abs=1e-15)


def test_a_neighbour_is_a_scene_and_does_not_begin_inside_a_wall():
    """Where the clearance is four times as wide as the distance. Control: with less there are no
    neighbours, nor without contact."""
    narrow = load("reference").replace({"contact.clearance": 4.0 * UM})
    assert neighbours.possible(narrow, UM)
    for row in neighbours.draw(narrow, UM, 50):
        scene = narrow.replace(row)
        shift = max(abs(scene.initial.position.y), abs(scene.initial.position.z))
        assert shift <= scene.contact.narrowest()
    assert not neighbours.possible(narrow, 1.1 * UM)
    assert not neighbours.possible(load("reference").replace({"contact": None}), UM)
