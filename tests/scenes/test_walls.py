"""The file of walls, and which scenes it serves."""

from dataclasses import replace

import numpy as np
import pytest

from tipoff import lowfi, scenes
from tipoff.mechanics.rail_compliance import PATTERNS, Walls, digest
from tipoff.scenes.faults import SceneError

SCENE = scenes.load("reference")
FACES = 16


@pytest.fixture
def walls():
    """Any numbers, for the pads and rail of the scene."""
    random = np.random.default_rng(4)
    flexibility = random.random((5, FACES, PATTERNS, FACES, PATTERNS))
    frequency, shape = (
        2e4 * np.arange(1.0, 4.0) * np.ones((4, 1)),
        random.random((5, FACES, PATTERNS, 3)),
    )
    return Walls(
        np.linspace(0.0, 0.2, 5),
        flexibility,
        np.arange(FACES) // 4,
        random.random((FACES, 2)),
        frequency,
        shape,
        digest(SCENE),
    )


def test_what_was_saved_is_loaded(walls, tmp_path):
    walls.save(tmp_path / "walls.npz")
    found = Walls.load(tmp_path / "walls.npz")
    assert all(
        np.array_equal(getattr(found, name), getattr(walls, name))
        for name in ("travel", "flexibility", "rail", "half", "frequency", "shape")
    )
    assert found.made_for == walls.made_for and found.rail.dtype == walls.rail.dtype
    assert [path.name for path in tmp_path.iterdir()] == ["walls.npz"]


def test_warm_walls_are_saved_too_and_older_files_know_of_none(walls, tmp_path):
    path, warm = tmp_path / "walls.npz", np.random.default_rng(9).random((5, 5, FACES, PATTERNS))
    known = replace(walls, warm=warm)
    known.save(path)
    assert np.array_equal(Walls.load(path).warm, warm) and known.hash != walls.hash
    walls.save(path)
    assert Walls.load(path).warm is None
    replace(walls, warm=warm[:4]).save(path)
    with pytest.raises(ValueError, match="warm: given shape"):
        Walls.load(path)


@pytest.mark.parametrize(
    "model, wrong, words",
    [
        ("springs", lambda walls: None, "given no walls"),
        ("compliant", lambda walls: walls, "know of no temperature"),
        ("springs", lambda walls: walls.rigid(), "know of no temperature"),
    ],
)
def test_a_warm_scene_asks_for_walls_that_know_of_it(walls, model, wrong, words):
    with pytest.raises(SceneError, match=words):
        lowfi.run(SCENE.replace({"thermal.mean": 20.0}), model, walls=wrong(walls))


def damage_end(path):
    path.write_bytes(path.read_bytes()[:-1000])


def damage_middle(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)


def make_text(path):
    path.write_text("travel = 1\n")


def make_empty(path):
    path.write_bytes(b"")


def make_foreign(path):
    np.savez(path, travel=np.zeros(3), stiffness=np.ones(3))


def make_one_array(path):
    with open(path, "wb") as stream:
        np.save(stream, np.zeros(3))


@pytest.mark.parametrize(
    "damage", [damage_end, damage_middle, make_text, make_empty, make_foreign, make_one_array]
)
def test_damaged_and_foreign_files_are_refused(walls, tmp_path, damage):
    path = tmp_path / "walls.npz"
    walls.save(path)
    Walls.load(path)
    damage(path)
    with pytest.raises(ValueError, match="not a file of walls"):
        Walls.load(path)


def test_arrays_that_do_not_belong_together_are_refused(walls, tmp_path):
    gap = walls.flexibility.copy()
    gap[2, 3, 0, 3, 0] = np.nan
    for change in (
        {"frequency": walls.frequency[:3]},
        {"shape": walls.shape[..., :2]},
        {"half": walls.half[1:]},
        {"rail": walls.rail[:, None]},
        {"flexibility": gap},
    ):
        replace(walls, **change).save(tmp_path / "walls.npz")
        with pytest.raises(ValueError, match="not a file of walls.*expected finite numbers"):
            Walls.load(tmp_path / "walls.npz")
    with pytest.raises(FileNotFoundError):
        Walls.load(tmp_path / "none.npz")


@pytest.mark.parametrize(
    "change",
    [
        {"rail.material.youngs_modulus": 70e9},
        {"rail.thickness": 3.9e-3},
        {"rail.end": 0.131},
        {"pads.0.relief": 1e-5},
        {"pads.3.position": (-0.079, 0.1, 0.1)},
    ],
    ids=str,
)
def test_another_rail_or_other_pads_are_refused(walls, change):
    with pytest.raises(SceneError, match="another rail, or other pads"):
        lowfi.run(SCENE.replace(change), walls=walls)


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"contact.clearance": 3e-4},
        {"contact.penalty": 1e12},
        {"payload.mass": 11.0},
        {"friction": None},
        {"rail.damping": {"ratios": [0.01, 0.02], "frequencies": [1000.0, 5000.0]}},
    ],
    ids=str,
)
def test_what_walls_do_not_depend_on_is_free_to_change(walls, change):
    walls.require(SCENE.replace(change))


def test_friction_that_sticks_is_refused(walls):
    law = {"law": "sticking", "static": 0.2, "dynamic": 0.2, "stiffness": 1e7, "damping": 1e4}
    with pytest.raises(SceneError, match="friction.law: given 'sticking', expected 'two-step'"):
        lowfi.run(SCENE.replace({"friction": law}), walls=walls)
