"""The benchmark: the baseline does the same work as the solver, and what is written is what was
measured."""

import functools
import json
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import tipoff
from tipoff import highfi, lowfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.stepper import Stepper, Taken
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.simulation import Loop
from tipoff.highfi.statics import assembly
from tipoff.lowfi.dynamics import cases
from tipoff.mechanics.books import DONE
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.mechanics.outcome import Outcome
from tipoff.scenes import load
from tipoff.studies import registry
from tipoff.studies.render import document
from tipoff.studies.report.assembly import render
from tipoff.studies.report.page import Page
from tipoff.studies.runs.figures import Runs
from validation import STUDIES
from validation.bench import done, parts, reference, surrogate
from validation.bench.command import bench
from validation.bench.csr_loop import CsrLoop
from validation.bench.done import NotDone
from validation.bench.methods import (
    PlainRungeKutta,
    Population,
    SolveIvp,
    Surrogate,
    varied,
)


def test_baseline_is_central_differences_on_the_assembled_matrix():
    scene = load("tiny")
    mesh = highfi.prepare(scene, Numerics(element_size=0.016))
    loop = CsrLoop(mesh, scene.rail.material, 1e-8, most=10**6)
    material = scene.rail.material
    operator = assembly.of_material(mesh, material, fixed=())
    displacement, velocity = loop.displacement.copy(), loop.velocity.copy()
    for _ in range(3):
        velocity = velocity - 1e-8 * (assembly.sparse(operator) @ displacement) / np.repeat(
            operator.mass, 3
        )
        displacement = displacement + 1e-8 * velocity
    loop.advance(3)
    assert loop.elements == len(mesh.cells) and loop.displacement == pytest.approx(
        displacement, rel=1e-12
    )


@pytest.mark.parametrize(
    "few, errors",
    [(5, (1.0, 0.5)), pytest.param(20, surrogate.REQUESTED, marks=pytest.mark.slow)],
)
def test_bench_writes_one_row_per_size(tmp_path, monkeypatch, figures, few, errors):
    monkeypatch.setattr(surrogate, "run", functools.partial(surrogate.run, few=few))
    monkeypatch.setattr(surrogate, "REQUESTED", errors)
    arguments = [
        "--element-size",
        "8",
        "--repeats",
        "1",
        "--steps",
        "50",
        "--cases",
        "40",
        "--out",
        str(tmp_path),
    ]
    app = typer.Typer()
    app.command()(bench)
    said = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert said.exit_code == 0
    assert "SciPy and" in said.stdout and "plain Runge-Kutta" in said.stdout
    assert f"  {tmp_path / 'bench' / 'lowfi.json'}" in said.stdout.splitlines()
    (row,) = json.loads((tmp_path / "bench" / "highfi.json").read_text())["rows"]
    assert row["elements"] > 500 and row["faces_in_contact"] >= 4
    assert row["ratio"] == pytest.approx(
        row["baseline_ns_per_element_step"] / row["ns_per_element_step"]
    )
    assert (
        row["times_stepped"]["pressed"] >= row["times_stepped"]["free"] == 50 == row["steps_timed"]
    )
    fastest = min(row[name] for name in ("ns_per_element_step", "ns_free", "ns_one_thread"))
    assert fastest * row["threads"] > 0.5  # no processor is faster
    assert row["bytes_per_element"] > 24 * 8 and row["dt_s"] > row["dt_element_s"] * 0.9
    assert f"{row['elements']:,} elements" in reference.line(row)
    (split,) = json.loads((tmp_path / "bench" / "parts.json").read_text())["rows"]
    assert split["elements"] == row["elements"] and "Parts of one step" in said.stdout
    assert min(split[f"{name}_us"] for name in ("elements", "contact", "bodies", "samples")) > 0.0
    parts = ("elements", "nodes", "joints", "contact", "bodies")
    apart = sum(split[f"{name}_error_us"] for name in (*parts, "step"))
    assert sum(split[f"{name}_us"] for name in parts) == pytest.approx(
        split["step_us"], rel=1e-9, abs=apart
    )
    monkeypatch.setattr(registry, "ADDED", [*STUDIES])
    page = render(
        Page(load("tiny"), tmp_path, {"bench": reference.stored(tmp_path)}, Runs({}, {}, {}), {})
    )
    assert 'id="bench"' in page and f"{row['elements']:,}" in page
    assert reference.stored(tmp_path / "elsewhere") is None
    found = json.loads((tmp_path / "bench" / "lowfi.json").read_text())
    for error in errors:
        methods = [row["method"] for row in found["single"] if row["error_percent"] == error]
        assert methods == ["compliant contact", "springs", PlainRungeKutta.name, SolveIvp.name]
    for row in found["single"]:
        assert row["measured_percent"] <= row["error_percent"] and row["cpu_ms"] > 0.0
        assert f"{row['cpu_ms']:.3f}" in page
        compliant = row["method"] == "compliant contact"
        assert (row["run_auto_cpu_ms"] is not None) == compliant
    assert "pilot cases" in found["modes_why"]
    for ensemble in found["ensembles"]:
        assert (
            ensemble["cases"] == ensemble["ok"] == 40
            and ensemble["cpu_ms_per_case"] > 0.0 < ensemble["wall_s"]
        )
        assert ensemble["peak_memory_bytes"] > 10**7


def test_a_loop_that_returns_early_has_no_time(tmp_path, monkeypatch):
    """Control: in the test above the same loop makes its steps."""
    monkeypatch.setattr(Stepper, "advance", lambda self, count: Taken(0, 0, 0.0, 0.0))
    with pytest.raises(NotDone, match="steps of the reference: 0 done, 5 asked for"):
        reference.run(tmp_path, (0.008,), repeats=1, steps=50)


def test_steps_of_some_rails_alone_have_no_time(tmp_path, monkeypatch):
    """Rails at rest are not stepped in a run. Control: all of them are, where there is a time."""
    made = reference.Again(_loop())
    made(3)
    resting = reference.Again(_loop(), stepped=False)
    with pytest.raises(NotDone, match=r"nodes that were stepped: [\d,]+ done, 0 asked for"):
        resting(3)
    part = _loop()
    part.stepper.state.stepped.in_use[0] -= 1
    with pytest.raises(NotDone, match="nodes that were stepped"):
        reference.Again(part)(3)


def _loop() -> Loop:
    """Pressed rails of ``tiny`` in coarse elements at their start."""
    scene, numerics = reference.pressed(load("tiny").condition("phi15")), Numerics(0.016)
    system = build(scene, numerics, highfi.prepare(scene, numerics))
    loop = Loop(set_up(scene, system, choose(system, scene, numerics), 1))
    loop.begin()
    return loop


@pytest.mark.parametrize(
    "change, words",
    [
        ({"status": "diverged"}, "diverged after 10 steps"),
        ({"cost": {"steps": 0}}, "exited after 0 steps"),
        ({"outcome": Outcome()}, "settled runs of it: 0 done, 1 asked for"),
        ({"cost": {"steps": 10, "element_steps": 10**9, "cpu_s": 0.01}}, "0.01, less than 0.5"),
    ],
)
def test_a_run_that_did_not_do_its_work_has_no_time(change, words):
    """Control: one that did."""
    cost = {"steps": 10, "element_steps": 1000, "cpu_s": 0.01}
    rated = Outcome(rate=(0.0, 0.0, 0.0))
    whole = {"status": "exited", "message": "", "cost": cost, "outcome": rated}
    done.require_run("it", SimpleNamespace(**whole))
    with pytest.raises(NotDone, match=words):
        done.require_run("it", SimpleNamespace(**whole | change))


def test_a_case_that_is_left_out_has_no_time():
    """A kernel that does nothing does not show the results of its last call. Control: one that
    works."""
    scene = load("tiny")
    method = Surrogate(Population(scene, varied(2), COMPLIANT, tipoff.compliance(scene)))
    piece = method.piece(1e-5)
    found = piece()
    assert method.solved(found) == 2
    for column, value in ((cases.LEFT_OPEN, 1.0), (cases.STEPS, 0.0), (cases.BOOK + DONE, np.inf)):
        changed = found.copy()
        changed[0, column] = value
        assert method.solved(changed) == 1
    assert method.solved(np.zeros_like(found)) == 0


def test_a_time_needs_what_was_asked():
    done.require("steps", 5, 5)
    done.require_at_least("ns", 0.5, 0.5)
    with pytest.raises(NotDone, match="cases: 4 done, 5 asked for"):
        done.require("cases", 4, 5)
    for value in (0.012, float("nan")):
        with pytest.raises(NotDone, match="less than 0.5"):
            done.require_at_least("ns", value, 0.5)


def test_runs_of_a_method_have_the_modes_of_its_population():
    """Otherwise the two columns of a row compare different equations."""
    scene = load("tiny")
    population = Population(scene, varied(2), COMPLIANT, tipoff.compliance(scene))
    population.modes = 3  # unlike what the cases need
    method, tolerance = Surrogate(population), 1e-5
    runs = method.whole(tolerance)()
    assert [run.numerics["modes"] for run in runs] == [3, 3]
    steps = method.piece(tolerance)()[:, cases.STEPS]
    same, other = (
        population.many(population.rows, lowfi.Numerics.of_many(tolerance, modes))
        for modes in (3, 0)
    )
    assert [run.cost["steps"] for run in runs] == same.steps.values.tolist()
    assert steps.tolist() == same.steps.values.tolist() != other.steps.values.tolist()
    for run in method.whole(tolerance, modes="auto")():
        assert "modes_why" in run.numerics


@pytest.mark.parametrize("value, shown", [(4.4, "4.4 ± 0.5"), (-105.3, "at most 1")])
def test_a_part_below_its_error_is_not_resolved(value, shown):
    """It was shown as a negative time."""
    names = ("step", "elements", "nodes", "joints", "contact", "bodies", "samples")
    row = {"element_size_m": 1e-3, "elements": 8, "steps_timed": 100}
    row |= {f"{name}_us": value for name in names} | {
        f"{name}_error_us": 0.5 if value > 0.0 else 30.0 for name in names
    }
    text = document.markdown([parts.table({"rows": [row], "repeats": 5})])
    assert text.count(shown) == len(names)
