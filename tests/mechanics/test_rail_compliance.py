"""The file of rail compliance, and which scenes it serves."""

import io
import tracemalloc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from tipoff import lowfi, scenes
from tipoff.faults import SceneError
from tipoff.files import write_sealed
from tipoff.mechanics.laws.thermal import FIELDS
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance, content, pairs, splines
from tipoff.mechanics.rail_compliance.joint_terms import JointTerms
from tipoff.mechanics.rail_compliance.patterns import DRAGGED
from tipoff.scenes.rail_compliance import digest, require

SCENE = scenes.load("reference")
FACES = 16


@pytest.fixture
def compliance():
    """Any numbers, for the pads and rail of the scene."""
    random = np.random.default_rng(4)
    rail = np.arange(FACES) // 4
    flexibility = random.random((5, FACES, 4, PATTERNS, PATTERNS))
    frequency, shape = (
        2e4 * np.arange(1.0, 4.0) * np.ones((4, 1)),
        random.random((5, FACES, PATTERNS, 3)),
    )
    return RailCompliance(
        np.linspace(0.0, 0.2, 5),
        flexibility,
        rail,
        random.random((FACES, 2)),
        frequency,
        shape,
        digest(SCENE),
    )


def test_what_was_saved_is_loaded(compliance, tmp_path):
    compliance.save(tmp_path / "walls.npz")
    found = RailCompliance.load(tmp_path / "walls.npz")
    assert all(
        np.array_equal(getattr(found, name), getattr(compliance, name))
        for name in ("travel", "flexibility", "rail", "half", "frequency", "shape")
    )
    assert found.made_for == compliance.made_for and found.rail.dtype == compliance.rail.dtype
    assert [path.name for path in tmp_path.iterdir()] == ["walls.npz"]


def test_what_follows_has_the_same_bits_computed_and_loaded(compliance, tmp_path):
    """Arrays of a calculation can have any order in memory, those of a file have that of rows."""
    turned = compliance.flexibility.transpose(3, 0, 2, 1, 4).copy().transpose(1, 3, 2, 0, 4)
    known = replace(compliance, flexibility=turned)
    known.save(tmp_path / "walls.npz")
    found = RailCompliance.load(tmp_path / "walls.npz")
    assert np.array_equal(found.compliance(), known.compliance())
    assert np.array_equal(found.cubic()[0], known.cubic()[0])


def test_warm_walls_are_saved_too_and_older_files_have_none(compliance, tmp_path):
    path, warm = tmp_path / "walls.npz", np.random.default_rng(9).random((5, 5, FACES, PATTERNS))
    known = replace(compliance, warm=warm)
    known.save(path)
    assert np.array_equal(RailCompliance.load(path).warm, warm) and known.hash != compliance.hash
    compliance.save(path)
    assert RailCompliance.load(path).warm is None
    replace(compliance, warm=warm[:4]).save(path)
    with pytest.raises(ValueError, match="warm: given shape"):
        RailCompliance.load(path)


@pytest.mark.parametrize(
    "model, wrong, words",
    [
        ("springs", lambda compliance: None, "given no rail compliance"),
        ("compliant", lambda compliance: compliance, "without thermal offset"),
        ("springs", lambda compliance: compliance.rigid(), "without thermal offset"),
    ],
)
def test_a_warm_scene_needs_warm_walls(compliance, model, wrong, words):
    with pytest.raises(SceneError, match=words):
        lowfi.run(SCENE.replace({"thermal.mean": 20.0}), model, compliance=wrong(compliance))


def write_with(path, compliance, change):
    """A whole file of ``compliance`` with other arrays."""
    stream = io.BytesIO()
    with np.load(io.BytesIO(content(compliance))) as arrays:
        np.savez(stream, **{**arrays, **change})
    write_sealed(path, stream.getvalue())


def test_arrays_that_do_not_belong_together_are_refused(compliance, tmp_path):
    gap = compliance.flexibility.copy()
    gap[2, 3, 0, 3, 0] = np.nan
    older = pairs.whole(compliance.flexibility, compliance.rail)  # faces on different rails too
    for change in (
        {"frequency": compliance.frequency[:3]},
        {"shape": compliance.shape[..., :2]},
        {"half": compliance.half[1:]},
        {"rail": compliance.rail[:, None]},
        {"flexibility": gap},
        {"flexibility": older},
    ):
        write_with(tmp_path / "walls.npz", compliance, change)
        with pytest.raises(
            ValueError, match="not a file of rail compliance.*expected finite numbers"
        ):
            RailCompliance.load(tmp_path / "walls.npz")
    write_with(tmp_path / "walls.npz", compliance, {"find_joints": np.zeros(1)})
    with pytest.raises(ValueError, match="find_joints: given an array"):
        RailCompliance.load(tmp_path / "walls.npz")
    with pytest.raises(FileNotFoundError):
        RailCompliance.load(tmp_path / "none.npz")


@pytest.mark.parametrize("given", JointTerms._fields)
def test_terms_of_joints_that_do_not_belong_together_are_refused(compliance, tmp_path, given):
    """They would end a later run with a factor on the stiffness of the mounts."""
    stations, faces, rails = len(compliance.travel), len(compliance.rail), len(compliance.frequency)
    modes = compliance.frequency.shape[1]
    whole = JointTerms(
        share=np.full((rails, 3), 0.5),
        moved=np.zeros((stations, faces, PATTERNS, 3)),
        moved_first=np.zeros((stations, faces, DRAGGED, 3)),
        moved_by_friction=np.zeros((stations, faces, DRAGGED, 3)),
        heated=np.zeros((rails, 3, FIELDS)),
        shape=np.zeros((stations, faces, PATTERNS, modes)),
        dragged_shape=np.zeros((stations, faces, DRAGGED, modes)),
        stiffness=np.tile(np.eye(modes), (rails, 1, 1)),
        joint=np.zeros((rails, modes, modes)),
    )
    path = tmp_path / "walls.npz"
    replace(compliance, joints=whole).save(path)
    assert RailCompliance.load(path).joints is not None
    for wrong in (
        getattr(whole, given).ravel(),
        getattr(whole, given)[:-1],
        getattr(whole, given) + 1j,
    ):
        replace(compliance, joints=whole._replace(**{given: wrong})).save(path)
        with pytest.raises(ValueError, match=f"joints.{given}"):
            RailCompliance.load(path)


def test_types_of_arrays_are_checked(compliance, tmp_path):
    for change in (
        {"rail": compliance.rail.astype(float)},
        {"rail": compliance.rail - 1},
        {"travel": compliance.travel[::-1]},
        {"travel": np.array(0.0)},
        {"frequency": compliance.frequency + 1j},
    ):
        write_with(tmp_path / "walls.npz", compliance, change)
        with pytest.raises(ValueError, match="not a file of rail compliance"):
            RailCompliance.load(tmp_path / "walls.npz")


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
def test_another_rail_or_other_pads_are_refused(compliance, change):
    with pytest.raises(SceneError, match="another rail, or other pads"):
        lowfi.run(SCENE.replace(change), compliance=compliance)


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"contact.clearance": 3e-4},
        {"contact.interface_stiffness": 1e12},
        {"payload.mass": 11.0},
        {"friction": None},
        {"rail.damping": {"ratios": [0.01, 0.02], "frequencies": [1000.0, 5000.0]}},
    ],
    ids=str,
)
def test_other_keys_of_the_scene_may_change(compliance, change):
    require(compliance, SCENE.replace(change))


def test_friction_that_sticks_is_refused(compliance):
    law = {"law": "sticking", "static": 0.2, "dynamic": 0.2, "stiffness": 1e7, "damping": 1e4}
    with pytest.raises(SceneError, match="friction.law: given 'sticking', expected 'two-step'"):
        lowfi.run(SCENE.replace({"friction": law}), compliance=compliance)


def test_splines_of_a_large_compliance_are_held_for_one_number_of_modes(monkeypatch):
    """Of any of the compliances in memory. Control: those of a small one stay for every number."""
    small = of_identity(5)
    held = small.cubic(0)[0]
    assert small.cubic(2)[0] is not held and small.cubic(0)[0] is held
    monkeypatch.setattr(splines, "LARGE", 0.0)
    first, other = of_identity(5), of_identity(5)
    for again in (first, other):
        held = first.cubic(0)[0]
        assert first.cubic(0)[0] is held
        ended = weakref.ref(held)
        del held
        assert again.cubic(1)[0] is again.cubic(1)[0] and ended() is None


def test_splines_above_a_size_are_held_without_modes_and_for_one_number(monkeypatch):
    """As in the pilot of an ensemble, where each case chooses another number. Control: the splines of a
    smaller one stay for every number."""
    for smallest, ends in ((np.inf, False), (0.0, True)):
        monkeypatch.setattr(splines, "SMALL", smallest)
        found = of_identity(5)
        without, one = found.cubic(0)[0], weakref.ref(found.cubic(1)[0])
        assert found.cubic(2)[0] is found.cubic(2)[0] and found.cubic(0)[0] is without
        assert (one() is None) is ends


def of_identity(stations: int) -> RailCompliance:
    """Two faces on one rail that only move themselves, with two modes."""
    flexibility = np.zeros((stations, 2, 2, PATTERNS, PATTERNS))
    flexibility[:, [0, 1], [0, 1]] = np.eye(PATTERNS)
    random = np.random.default_rng(2)
    return RailCompliance(
        np.linspace(0.0, 1.0, stations),
        flexibility,
        np.zeros(2, dtype=int),
        np.ones((2, 2)),
        np.array([[1e3, 2e3]]),
        random.random((stations, 2, PATTERNS, 2)),
        digest(SCENE),
    )


def test_the_rest_without_modes_takes_the_memory_of_one_table():
    """Control: the products of the modes of all stations at once take another one."""
    large = of_identity(20_000)
    table, part = large.flexibility, large.shape.reshape(20_000, -1, 2) / large.frequency

    def most(make) -> float:
        tracemalloc.start()
        found = make()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert found is not None
        return peak / table.nbytes

    assert most(lambda: large.residual(2)) < 2.0 - 0.1
    assert most(lambda: table - pairs.blocks(part @ part.swapaxes(1, 2), 2)) > 2.0 - 0.1
    every = table - pairs.blocks(part @ part.swapaxes(1, 2), 2)
    assert np.array_equal(large.residual(2), every)
