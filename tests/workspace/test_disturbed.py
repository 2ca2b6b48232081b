"""How far small disturbances move a run: against runs made by hand, and the words."""

from dataclasses import replace

import numpy as np
import pytest

from tipoff import lowfi, scenes
from tipoff.results.trajectory import Trajectory
from tipoff.workspace import disturbed
from tipoff.workspace.run import Run
from tipoff.workspace.store import Store

REFERENCE = scenes.load("reference")


def moved(condition: str, change: float = 1e-6) -> tuple[disturbed.Disturbed, Trajectory]:
    """The result on springs, and the run itself."""
    scene = REFERENCE.condition(condition)
    run = Run("lowfi", condition, scene, lowfi.Numerics())
    nominal = lowfi.run(scene, "springs")
    return disturbed.measured(run, nominal, change), nominal


def test_changes_are_those_of_runs_made_by_hand():
    found, nominal = moved("phi60")
    scene, clearance = REFERENCE.condition("phi60"), REFERENCE.contact.clearance
    by_hand = [
        lowfi.run(scene.replace({"contact.clearance": clearance + change}), "springs").outcome.rate
        for change in (1e-6, -1e-6)
    ]
    apart = np.degrees(np.abs(np.subtract(by_hand, nominal.outcome.rate)).max())
    assert apart > 1e-3
    assert found.by_clearance_deg_s == pytest.approx(apart, rel=1e-12)
    finest = lowfi.run(scene, "springs", numerics=lowfi.Numerics(relative_tolerance=1e-10))
    apart = np.degrees(np.abs(np.subtract(finest.outcome.rate, nominal.outcome.rate)).max())
    assert 0.0 < apart < 1e-3
    assert found.by_tolerance_deg_s == pytest.approx(apart, rel=1e-12)


def test_a_negative_clearance_is_left_out_and_free_flight_has_none():
    scene = REFERENCE.condition("phi60").replace({"contact.clearance": 0.0})
    found = disturbed.measured(
        Run("lowfi", "phi60", scene, lowfi.Numerics()), lowfi.run(scene, "springs"), 1e-6
    )
    assert found.by_clearance_deg_s > 0.0
    free = REFERENCE.replace({"contact": None, "friction": None})
    found = disturbed.measured(Run("lowfi", "free", free, lowfi.Numerics()), lowfi.run(free), 1e-6)
    assert found.clearance_change_m is None and found.by_tolerance_deg_s < 1e-6


def test_clearances_along_the_axes_are_disturbed_too():
    """Both change as the one clearance does, up to the arms. Control: the run does not see that one
    where both axes state their own."""
    axes = {f"contact.clearance_{axis}": REFERENCE.contact.clearance for axis in "yz"}
    scene = REFERENCE.condition("phi60").replace(axes)
    nominal = lowfi.run(scene, "springs")
    found = disturbed.measured(Run("lowfi", "phi60", scene, lowfi.Numerics()), nominal, 1e-6)
    expected = moved("phi60")[0].by_clearance_deg_s
    assert found.by_clearance_deg_s == pytest.approx(expected, rel=0.05)


def test_disturbed_runs_are_made_once(tmp_path, monkeypatch, capsys):
    """A second call reads their result. Control: another change, another run and a damaged file make
    them again."""
    calls, execute = [], disturbed.execute
    monkeypatch.setattr(disturbed, "execute", lambda run: calls.append(run) or execute(run))
    store, numerics = Store(tmp_path), lowfi.Numerics(relative_tolerance=1e-6)

    def kept(condition: str = "phi60", change: float = 1e-6) -> tuple[disturbed.Disturbed, int]:
        run = Run("lowfi", condition, REFERENCE.condition(condition), numerics)
        before = len(calls)
        found = disturbed.kept(store, run, lowfi.run(run.scene, "springs"), change)
        return found, len(calls) - before

    first, made = kept()
    assert made == 3 and kept() == (first, 0)
    assert kept(change=2e-6)[1] == 3 and kept("phi35")[1] == 3
    assert kept() == (first, 3)  # one file beside the run
    for path in tmp_path.rglob("*.disturbed.json"):
        path.write_text(path.read_text().replace("by_tolerance", "by_"))
    assert kept() == (first, 3)
    assert "its disturbed runs are made again" in capsys.readouterr().err


@pytest.mark.parametrize("condition, warned", [("phi60", False), ("h8", True)])
def test_a_sensitive_run_says_so(condition, warned):
    found = moved(condition)[0]
    assert "deg/s by 1 µm of clearance" in disturbed.lines(found)[0]
    assert any(words.startswith("sensitive") for words in disturbed.warnings(found, 0.1)) is warned


def test_a_disturbed_run_that_does_not_settle_is_a_warning():
    found = replace(moved("phi60")[0], by_clearance_deg_s=None)
    assert "1 µm of clearance: does not settle" in disturbed.lines(found)[0]
    (words,) = disturbed.warnings(found, 0.1)
    assert "1 µm of clearance prevents the run from settling" in words
