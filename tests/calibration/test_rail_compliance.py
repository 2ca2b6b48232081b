"""The rail compliance that is kept in a folder: its elements, what it is kept under, what is said."""

import shutil
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.highfi.rail.test_own_rail import channels
from tests.in_memory import memory
from tipoff import calibration
from tipoff.calibration import rail_compliance
from tipoff.highfi import compliance as statics
from tipoff.highfi import discretisation
from tipoff.highfi.rail import nodal, places
from tipoff.scenes import SceneError, load
from tipoff.scenes.rail_compliance import digest
from tipoff.scenes.scene import Scene

# Every effect that a scene of tests can have without a file, so that every number of it is there.
EVERYTHING = {
    "rail.mount_stiffness": {"normal": 1e13, "shear": 5e12, "factor": 1.5},
    "rail.damping": {"frequencies": [100.0, 1e4], "ratios": [0.01, 0.02]},
    "rail.material.expansion": 2e-5,
    "rail.fillet": 9e-4,
    "thermal": {"mean": 20.0, "platform_strain": 1e-5},
    "gravity": {"z": -9.8},
    "mass_offset.eccentricity.axial": 1e-3,
    "initial": {"velocity": {"x": 0.1}},
    "contact.clearance_y": 3e-4,
    "conditions": None,
    "agreement": None,
    "provenance": None,
}
# Keys of which no compliance is computed: one that all of them share.
NOT_READ = {
    "duration",
    "payload.mass",
    "payload.inertia.xx",
    "thrust.peak",
    "friction.dynamic",
    "contact.stiffness",
    "contact.interface_stiffness",
    "platform.mass",
    "platform.mass_centre.x",
    "mass_offset.eccentricity.axial",
    "gravity.z",
    "thermal.mean",
    "rail.material.expansion",
    "rail.mount_stiffness.factor",
    "output.interval",
    "studies.element_size",
}
READ = {
    "contact.clearance",
    "pads.0.position.1",
    "pads.0.width",
    "rail.leg",
    "rail.fillet",
    "rail.end",
    "rail.mounts.1.start",
    "rail.mount_stiffness.normal",
    "rail.material.density",
    "rail.material.youngs_modulus",
}


def numbers(value: Any, key: str = "") -> Iterator[tuple[str, float]]:
    """Dotted keys and values of all numbers in a scene in SI, conditions apart."""
    if isinstance(value, dict):
        for name, item in value.items():
            if name not in ("conditions", "agreement", "provenance"):
                yield from numbers(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from numbers(item, f"{key}.{place}")
    elif type(value) is float:
        yield key, value


def changed(scene: Scene, key: str, value: float) -> tuple[dict, str] | None:
    """Overrides, and what a compliance is then kept under, for a little more or less under ``key``; of
    all pads alike, as the section needs. None where the scene can have neither."""
    head, _, rest = key.partition(".")
    keys = {key: value}
    if head == "pads":
        name, stated = rest.partition(".")[2], dict(numbers(scene.resolved()))
        names = [f"pads.{place}.{name}" for place in range(len(scene.pads))]
        keys = {each: stated[each] for each in names}
    for factor in (1.02, 0.98):
        changes = {each: factor * old or 1e-4 for each, old in keys.items()}
        try:
            return changes, rail_compliance.made_from(scene.replace(changes))
        except SceneError:
            continue
    return None


def found(scene: Scene, size: float) -> str:
    """Digest of all numbers of a compliance of few places."""
    few = statics.condense(scene, size, spacing=0.15, modes=2)
    return replace(few, made_for="").hash


def test_a_compliance_is_kept_under_all_that_it_is_computed_from():
    """Every number of a scene is changed by 2 %. Those that do not change the name under which the
    compliance is kept do not change a bit of it, all of them together. Control: the digest of rail and
    pads alone does not change with the clearance either, and the compliance does."""
    scene = load("tiny").condition("phi15").replace(EVERYTHING)
    own, apart, alike = rail_compliance.made_from(scene), set(), {}
    for key, value in numbers(scene.resolved()):
        if key.startswith("pads.") and not key.startswith("pads.0."):
            continue  # they change with the first
        if (found_for := changed(scene, key, value)) is None:
            continue
        changes, kept_under = found_for
        if kept_under == own:
            alike |= changes
        else:
            apart.add(key)
    assert apart >= READ and set(alike) >= NOT_READ
    base = found(scene, 16e-3)
    assert found(scene.replace(alike), 16e-3) == base
    wider = scene.replace({"contact.clearance": 1.02 * scene.contact.clearance})
    assert digest(wider) == digest(scene) and found(wider, 16e-3) != base


def test_the_faces_of_a_rail_from_a_file_are_part_of_it():
    """Which walls they are on, and where, whatever moves them there."""
    scene = channels()
    own = rail_compliance.made_from(scene)
    for key in ("contact.clearance", "rail.clearance"):
        other = scene.replace({key: 2.6e-4})
        assert rail_compliance.made_from(other) != own
    assert rail_compliance.made_from(scene.replace({"duration": "30 ms"})) == own


def test_the_elements_are_those_that_are_asked_for_or_of_the_scene(monkeypatch):
    def condense(scene, size, held, degree):
        return SimpleNamespace(finding=lambda joints: size, nodes=None)

    monkeypatch.setattr(statics, "condense", condense)
    monkeypatch.setattr(discretisation, "stated", lambda scene, size, found, rails: found)
    assert calibration.compliance(load("tiny"), 6e-3) == 6e-3
    assert calibration.compliance(load("tiny")) == 8e-3
    assert calibration.compliance(load("clamped").replace({"name": "tiny"})) == 2e-3


def _said(monkeypatch, tmp_path, seconds: float) -> list[str]:
    """What is said while four equal parts of the loads take ``seconds`` each."""
    now = 0.0

    def condense(scene, size, held, degree):
        nonlocal now
        report = places.reported()
        for part in range(4):
            now += seconds
            report(0.25 * (part + 1))
        found = SimpleNamespace(accuracy=lambda: "", nodes=None)
        found.finding = lambda joints: found
        return found

    monkeypatch.setattr(rail_compliance, "KEPT", memory())
    monkeypatch.setattr(rail_compliance.time, "perf_counter", lambda: now)
    monkeypatch.setattr(statics, "condense", condense)
    monkeypatch.setattr(discretisation, "stated", lambda scene, size, found, rails: found)
    lines: list[str] = []
    rail_compliance.kept(load("tiny"), tmp_path, 8e-3, lines.append)
    return lines


def test_a_long_wait_says_how_long_it_takes(monkeypatch, tmp_path):
    """Four minutes; control: four seconds say nothing."""
    first, *left, last, _ = _said(monkeypatch, tmp_path / "long", 60.0)
    assert "rail compliance, once" in first and "computed in 240 s" in last
    assert left == [
        "  loads 50 %, about 2 min left; coarser elements take less",
        "  loads 75 %, about 60 s left",
    ]
    assert len(_said(monkeypatch, tmp_path / "short", 1.0)) == 3


def test_the_elements_and_their_uncertainty_are_stored_and_said_once(tmp_path):
    """From the file as when it was made. Control: the same size asked for in another folder is another
    file, which is said too."""
    lines: list[str] = []
    scene = load("tiny")
    folders = [tmp_path / "one"] * 2
    made, found = (rail_compliance.kept(scene, each, 16e-3, lines.append) for each in folders)
    assert found.stated() == made.stated() and found.hash == made.hash
    assert found.uncertainty.min() > 0.1 and found.frequency_uncertainty > 0.01
    said = [line for line in lines if "mm elements: uncertainty" in line]
    assert said == [f"  {made.accuracy()}"] and "(from 16 and 8 mm)" in said[0]
    shutil.copytree(tmp_path / "one", tmp_path / "other")
    rail_compliance.kept(scene, tmp_path / "other", 16e-3, lines.append)
    assert lines[-1] == said[0] and lines.count(said[0]) == 2


def test_the_loads_solved_for_are_reported(monkeypatch):
    """Every batch of a rail, up to all of it."""
    monkeypatch.setattr(places, "BATCH", 2)
    seen = []
    with places.progress_to(seen.append):
        rail_compliance.direct(load("tiny"), 16e-3)
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 3
    rail_compliance.direct(load("tiny"), 16e-3)
    assert seen[-1] == 1.0 and seen.count(1.0) == 1


def test_threads_do_not_change_a_bit(monkeypatch):
    """Batches that are solved for side by side, and one after another."""
    monkeypatch.setattr(places, "BATCH", 2)
    found = []
    for cores in (1, 4):
        monkeypatch.setattr(places, "processors", lambda cores=cores: cores)
        found.append(statics.condense(load("tiny"), 16e-3).hash)
    assert found[0] == found[1]


def test_a_long_rail_has_its_uncertainty_when_it_is_first_used(monkeypatch, tmp_path):
    """That of a compliance which waits for it, computed once and read again. A run needs none. Control: that
    of a short rail is in the file of its compliance."""
    monkeypatch.setattr(nodal, "LEAST_BYTES", 0.0)
    mounts = [{"start": start, "end": start + 0.06} for start in (0.06, 0.8)]
    scene = load("rocket_rail").replace({"rail.end": 0.28, "rail.mounts": mounts})
    own = tmp_path / "own"
    made = rail_compliance.kept(scene, own, 20e-3)
    assert made.nodes is not None and made.uncertainty is None and made.element_size == 20e-3
    assert not list(own.glob("*.json"))
    known, expected = made.known(), calibration.compliance(scene, 20e-3)
    np.testing.assert_array_equal(known.uncertainty, expected.uncertainty)
    assert known.hash == made.hash == expected.hash
    stated, other = made.stated(), expected.stated()
    assert stated is not None and other is not None
    # Frequencies of the same matrix differ in their last digits from one solution to the next.
    assert stated.pop("frequency_uncertainty") == pytest.approx(
        other.pop("frequency_uncertainty"), rel=1e-9
    )
    assert stated == other
    assert made.softer.hash != made.hash
    softer = expected.softer.flexibility
    np.testing.assert_allclose(
        made.softer.flexibility, softer, rtol=0.0, atol=1e-9 * np.abs(softer).max()
    )

    shutil.copytree(own, tmp_path / "other")
    monkeypatch.setattr(discretisation, "of_scene", None)
    found = rail_compliance.kept(scene, tmp_path / "other", 20e-3)
    assert found is not made and found.stated() == made.stated()
    monkeypatch.undo()
    short = rail_compliance.kept(load("tiny"), own, 16e-3)
    assert short.nodes is None and short.known() is short and short.uncertainty is not None
