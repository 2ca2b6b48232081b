"""Small parts of the stages that need no run."""

from dataclasses import asdict, replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.studies.cost.made import point
from tipoff import scenes
from tipoff.files import write_json
from tipoff.highfi.mesh.facets import area
from tipoff.highfi.state.records import COUNTED as COUNTED_BY_REFERENCE
from tipoff.lowfi.system import COUNTED
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.studies.ablation import stage as ablation
from tipoff.studies.agreement import interface, refinement
from tipoff.studies.cost import stage as cost
from tipoff.studies.sweeps import stage as sweeps
from tipoff.workspace import machine
from tipoff.workspace.settings import Settings, defaults
from tipoff.workspace.study import Study
from validation.stability import weaker_methods


def test_area_of_quadrilaterals():
    points = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [0, 0, 5], [2, 0, 5]], dtype=float
    )
    assert area(points, np.array([[0, 1, 2, 3], [0, 1, 5, 4]])) == pytest.approx(6.0 + 10.0)


def test_area_of_curved_triangles():
    """A half disc of six-node triangles is short of the disc by no more than their edges are."""
    points = np.array(
        [[0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 0, 0], [2**0.5, 2**0.5, 0], [0, 1, 0]], dtype=float
    )
    assert area(points, np.array([[0, 1, 2, 3, 4, 5]])) == pytest.approx(np.pi, rel=0.02)


def test_ablation_of_a_settled_scene_leaves_out_what_holds_its_payload():
    """Without weight or walls nothing rests. Both lines were refused, and with them the whole study."""
    resting = {"platform": None, "gravity.z": "-9.81 m/s**2", "initial.settled": True}
    scene = scenes.load("tiny").condition("phi15").replace(resting)
    lines = ablation.variants(scene)
    settled = {line: scene.replace(changes).initial for line, changes in lines.items()}
    assert {line for line in lines if line.endswith(", not settled")} == {
        "without contact, not settled",
        "without gravity, not settled",
    }
    assert all(
        start is None or start.settled != line.endswith(", not settled")
        for line, start in settled.items()
    )
    assert settled["without initial"] is None and settled["no effect"] is None


def test_ablation_takes_every_effect_away_once():
    # a hold-down is added to no scene: its release depends on the thrust
    scene = scenes.load("tiny").condition("phi15").replace({"hold_down.release": "500 N"})
    lines = ablation.variants(scene)
    everything = scene.replace(lines["all effects"])
    assert everything.absent_effects() == []
    effects = [effect.key for effect in EFFECTS]
    for effect in effects:
        assert scene.replace(lines[f"without {effect}"]).absent_effects() == [effect]
    assert scene.replace(lines["as the scene asks"]).hash == scene.hash
    assert len(scene.replace(lines["no effect"]).absent_effects()) == len(effects)
    assert "without friction" not in ablation.variants(scene.replace({"friction": None}))
    assert "without thermal" not in ablation.variants(
        scene.replace({"rail.material.expansion": None})
    )
    # Every effect with a law of its own is counted in both models;
    # sticking is a second law of friction and pushers one of the thrust, the reference feels
    # temperature before its kernels run, and the surrogate has damping and mounts in its modes and
    # its rail compliance.
    assert (set(COUNTED) - {"sticking", "pushers", "compliance", "modes"}) | {
        "mass_offset",
        "initial",
        "rail.damping",
        "rail.mount_stiffness",
    } == set(effects)
    assert (set(COUNTED_BY_REFERENCE) - {"pushers"}) | {"mass_offset", "initial", "thermal"} == set(
        effects
    )


def test_surrogate_is_timed_by_turns(monkeypatch, tmp_path):
    """Control: were each variant repeated by itself, the order would be aabbcc."""
    order = []

    def timed(run):
        order.append(run.label)
        return SimpleNamespace(label=run.label, cost={"kernel_s": float(len(order))}), 0.0, 0.0

    monkeypatch.setattr(ablation, "warm_up", lambda run: None)
    monkeypatch.setattr(ablation, "timed", timed)
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: None)
    study = Study(scenes.load("tiny"), tmp_path, replace(defaults("tiny"), lowfi_repeats=3))
    lines = {"a": {}, "b": {"friction": None}}
    requested = ablation.surrogate_runs(study, "phi15", lines)
    runs, times = ablation.timed_surrogate(study, requested)
    assert order == ["phi15-a", "phi15-b"] * 3
    assert [run.label for run in runs] == ["phi15-a", "phi15-b"] and times == [3.0, 4.0]


def test_pareto_front():
    """Two with errors below the band of the finest mesh count as equal: the faster one is best."""
    points = [
        point(setting=setting, numerics=f"{setting}", error_deg_s=error, wall_s=wall)
        for setting, (error, wall) in enumerate(
            ((1.0, 1.0), (0.5, 2.0), (0.6, 3.0), (None, 9.0), (0.1, 6.0), (0.05, 7.0))
        )
    ]
    assert [item.pareto for item in cost.marked(points, 0.2)] == [
        True,
        True,
        False,
        False,
        True,
        False,
    ]
    # an error band that is not known tells no two errors apart
    assert not any(item.pareto for item in cost.marked(points, None))


def test_matched_meshes():
    """An error that a loose tolerance hides by luck does not count, nor the time of one that spoils
    the model, nor what another number of modes reached."""

    def measured(model, setting, error, integration, wall):
        return point(
            model=model,
            setting=setting,
            numerics=f"{setting:g}",
            error_deg_s=error,
            integration_error_deg_s=integration,
            wall_s=wall,
            reference=error is None,
        )

    meshes = [
        measured(cost.FINITE_ELEMENTS, *rest)
        for rest in ((8.0, 0.07, None, 3.0), (4.0, 0.02, None, 6.0), (2.0, None, None, 40.0))
    ]
    lucky = [
        measured("lucky", *rest)
        for rest in (
            (1e-2, 0.001, 0.04, 0.001),
            (1e-4, 0.031, 0.001, 0.002),
            (1e-8, 0.03, None, 0.004),
        )
    ]
    exact = [
        measured("exact", *rest)
        for rest in ((1e-4, 0.011, 0.001, 0.002), (1e-8, 0.01, None, 0.004))
    ]
    modes = replace(measured("exact", 2e-7, 0.001, None, 1e-4), modes=8)
    first, second = cost.matched([*meshes, *lucky, *exact, modes])
    assert (first.error_deg_s, first.numerics, first.mesh, first.ratio) == (
        0.03,
        "0.0001",
        "4",
        3000.0,
    )
    assert (
        second.error_deg_s,
        second.numerics,
        second.mesh,
        second.mesh_error_deg_s,
    ) == (0.01, "0.0001", "2", None)
    # a mesh that jammed has no error; it is no reference and matches nothing, however fast it is
    jammed = replace(meshes[0], error_deg_s=None, reference=False, wall_s=0.1)
    assert cost.matched([jammed, *meshes[1:], *exact])[0].mesh == "2"
    assert cost.matched([jammed, *exact]) == []
    # nor is a surrogate matched that does not settle at its tightest tolerance
    lost = [exact[0], replace(exact[1], error_deg_s=None)]
    assert cost.matched([*meshes, *lost]) == []


def test_closed_gap_is_only_opened():
    closed = scenes.load("tiny").replace({"contact.clearance": 0.0}).contact
    assert closed.either_way(1e-6) == {"plus": {"contact.clearance": 1e-6}}


def test_refinements_change_one_thing_each(tmp_path):
    """And only those of the scene's refined conditions are by more than the mesh."""
    study = Study(scenes.load("tiny"), tmp_path, defaults("tiny"))
    groups = refinement.groups(study, "phi15")
    coarse, nominal = study.coarse("phi15"), study.highfi("phi15")
    assert [run.numerics for run in groups["mesh"].runs] == [coarse.numerics, nominal.numerics]
    half = replace(coarse.numerics, safety=0.5 * coarse.numerics.safety)
    assert [run.numerics for run in groups["step"].runs] == [coarse.numerics, half]
    assert [run.numerics.cells for run in groups["cells"].runs] == [8, None, 32]
    for group in groups.values():
        assert list(group.sizes) == sorted(group.sizes, reverse=True)
        assert {run.scene.hash for run in group.runs} == {nominal.scene.hash}
    used = {cause: group.runs[group.used] for cause, group in groups.items()}
    assert used["mesh"].numerics == nominal.numerics
    assert used["step"].numerics == used["cells"].numerics == coarse.numerics
    assert list(refinement.groups(study, "phi60")) == ["mesh"]


def test_the_interface_stiffness_is_changed_alone(tmp_path):
    """At a quarter, once and four times; once is the run that other stages use."""
    study = Study(scenes.load("tiny"), tmp_path, defaults("tiny"))
    coarse = study.coarse("phi15")
    runs = [interface.reference(study, "phi15", factor) for factor in interface.FACTORS]
    found = [run.scene.contact.interface_stiffness for run in runs]
    assert found == [factor * coarse.scene.contact.interface_stiffness for factor in (0.25, 1, 4)]
    assert {run.numerics for run in runs} == {coarse.numerics}
    assert runs[1].label == coarse.label and runs[1].scene.hash == coarse.scene.hash


def test_machine_is_described():
    found = machine.describe()
    assert found["cores"] >= 1 and found["processor"]


@pytest.mark.parametrize(
    "method, order",
    [
        (weaker_methods.runge_kutta, 4),
        (weaker_methods.semi_implicit_euler, 1),
        (weaker_methods.explicit_euler, 1),
    ],
)
def test_weaker_methods_have_their_order(method, order):
    """x'' = -x from rest at 1 to t = 1: a control that fails because it is wrong would prove
    nothing."""

    def error(count):
        x, v = method(lambda _, x, __: -x, 1.0, 0.0, 1.0 / count, count)
        return np.hypot(x - np.cos(1.0), v + np.sin(1.0))

    assert np.log2(error(40) / error(80)) == pytest.approx(order, abs=0.1)


def test_a_stored_result_is_one_of_the_present_settings_and_code(tmp_path):
    """Other code may have called its settings something else: that is no result, and no error
    either."""
    study = Study(scenes.load("tiny"), tmp_path, Settings())
    asked = asdict(sweeps.SensitivityOptions())
    for found, known in (
        ({"asked": asked, "key": "of another scene"}, False),
        ({"asked": asked | {"turns": 3}, "key": "x"}, False),
        ({"key": "x"}, False),
        ({"asked": [], "key": "x"}, False),
        ({"asked": asked, "key": "right"}, True),
    ):
        write_json(tmp_path / "sweeps.json", found)
        assert (
            study.stored(
                "sweeps", lambda result: sweeps.SensitivityOptions(**result["asked"]) and "right"
            )
            is not None
        ) == known
    assert study.stored("limits", lambda result: "right") is None
