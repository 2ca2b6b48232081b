"""The stage ``convergence`` on stubbed runs whose rates follow a law: what it asks for, what it
finds, and what it says."""

import pytest

from tests.studies.convergence import stub
from tests.studies.synthetic import undrawn
from tipoff import scenes
from tipoff.faults import SceneError
from tipoff.studies import registry
from tipoff.studies.convergence import page as convergence_page
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.convergence.options import ConvergenceOptions
from tipoff.studies.convergence.page import sentences
from tipoff.studies.render import document
from tipoff.studies.render.table import inline
from tipoff.studies.report import stage as report
from tipoff.studies.report.page import Page
from tipoff.studies.runs.figures import Runs
from tipoff.workspace.settings import Settings, defaults
from tipoff.workspace.study import Study, StudyError


def made(study) -> convergence.Convergence:
    """The result of a run."""
    return convergence.run(study).result


def page_of(study, found):
    """A report with this study alone."""
    return Page(study.scene, study.folder, {"convergence": found}, Runs({}, {}, {}), {})


def test_order_and_uncertainty_of_a_law_of_second_order(finished):
    found = finished[1].result
    x = stub.row(found, "element size", "settled rate x")
    assert (x.unit, x.size_unit, x.sizes) == ("deg/s", "m", [0.016, 0.008, 0.004])
    assert x.order == pytest.approx(2.0, abs=1e-9)
    assert x.uncertainty == pytest.approx(1.25 * 0.016)
    assert x.gci_percent == pytest.approx(125.0 * 0.016 / x.values[-1])
    # At 8 mm, as other stages run, the error is 0.064: what lies between the values, and the
    # uncertainty of the finest.
    assert x.nominal_uncertainty == pytest.approx(0.064 - 0.016 + 1.25 * 0.016)
    in_time = stub.row(found, "time step", "settled rate x")
    assert in_time.sizes == [0.9, 0.45, 0.225]
    assert in_time.order == pytest.approx(2.0, abs=1e-9)
    assert in_time.uncertainty == pytest.approx(1.25 * 0.1 * 0.225**2)


def test_values_without_order_are_told_apart(finished):
    found = finished[1].result
    y = stub.row(found, "element size", "settled rate y")
    assert y.order is None and y.method == "not converged: changes do not fall"
    assert y.uncertainty == pytest.approx(3.0 * 0.3)
    assert stub.row(found, "element size", "settled rate z").method == "no change at all"
    line = sentences(found)[0]
    assert "element size on phi15" in line and "1.2 deg/s at the default 8 mm" in line
    assert line.endswith("0.9 deg/s at 4 mm; not converged: changes do not fall")


def test_interface_stiffness_and_contact_cells_are_compared_with_the_nominal_run(finished):
    found = finished[1].result
    assert [item.factor for item in found.interface_stiffness] == [0.25, 1.0, 4.0, 16.0]
    assert [item.settled_rate_change_deg_s for item in found.interface_stiffness] == pytest.approx(
        [0.02, 0.0, 0.02, 0.04]
    )
    assert (
        found.interface_stiffness[3].interface_stiffness_n_m3
        == 16.0 * stub.NOMINAL_INTERFACE_STIFFNESS
    )
    changes = {item.cells_per_edge: item.settled_rate_change_deg_s for item in found.contact_cells}
    assert changes == {8: 0.0, 16: 0.0, 32: 0.0}
    assert sentences(found)[2:4] == [
        "interface stiffness, times 0.25 to 16: a settled rate changes by up to 0.04 deg/s",
        "contact cells along each edge of a pad, 8 to 32: a settled rate changes by up to 0 deg/s",
    ]


@pytest.mark.parametrize("error, size, sufficient", [(1.0, 16e-3, True), (0.8, 4e-3, False)])
def test_speed_is_measured_on_the_coarsest_sufficient_mesh(
    study, monkeypatch, error, size, sufficient
):
    """y jumps by 0.3 deg/s, which leaves 0.9 open at 4 mm, and as much at 16 mm."""
    monkeypatch.setattr(stub, "SURROGATE_ERROR", error)
    found = made(study)
    equal = found.equal_accuracy
    assert (equal.element_size_m, equal.surer) == (size, sufficient)
    assert equal.error_deg_s == pytest.approx(error)
    assert equal.ratio > 0.0 and equal.highfi_repeats == study.settings.highfi_repeats
    assert (
        "equal accuracy on phi15" in sentences(found)[-1]
        and ("at least" in sentences(found)[-1]) is not sufficient
    )


def test_no_run_is_made_twice_and_none_again(study, asked):
    """The run on the coarse mesh serves all four tables: it is one mesh, one step, one interface
    stiffness, and eight points are its own rule."""
    convergence.run(study)
    assert sorted(asked) == sorted(
        [
            "phi15" + tag
            for tag in (
                "",
                "-coarse",
                "-4mm",
                "-step-coarse",
                "-safety-0.225-coarse",
                "-interface-0.25-coarse",
                "-interface-4-coarse",
                # the last is the surrogate
                "-interface-16-coarse",
                "-cells-8-coarse",
                "-cells-32-coarse",
            )
        ]
        + ["phi15"]
    )
    del asked[:]
    convergence.run(study)
    assert asked == []
    assert (
        convergence.run(study, ConvergenceOptions("phi60")).result.condition == "phi60"
        and len(asked) == 11
    )


def test_four_meshes_of_the_reference():
    assert defaults("reference").mesh_sizes == (0.008, 0.004, 0.002, 0.001)
    assert Settings(element_size=0.006).mesh_sizes == pytest.approx((0.024, 0.012, 0.006, 0.003))


def test_run_that_did_not_settle_leaves_its_error_unknown(study, asked):
    asked.failing = {"phi15-4mm": "jammed", "phi15-interface-16-coarse": "diverged"}
    found = made(study)
    x = stub.row(found, "element size", "settled rate x")
    assert (x.uncertainty, x.nominal_uncertainty, x.method) == (
        None,
        None,
        "a run did not settle",
    )
    assert "unknown" in sentences(found)[0]
    assert stub.row(found, "element size", "contact impulse, pad 2").uncertainty == 0.0
    assert found.interface_stiffness[3].settled_rate_deg_s == [None] * 3
    assert sentences(found)[2].endswith("up to 0.02 deg/s; 16 diverged")


def test_mesh_that_diverges_stops_the_stage(study, asked):
    asked.failing = {"phi15-4mm": "diverged"}
    with pytest.raises(StudyError, match="phi15-4mm: diverged"):
        convergence.run(study)
    assert not study.path("convergence.json").exists()


def test_scene_without_contact_has_no_loads_and_no_interface_stiffness(tmp_path, asked):
    scene = scenes.load("tiny").replace({"contact": None, "friction": None})
    found = made(Study(scene, tmp_path, defaults("tiny")))
    assert (
        found.interface_stiffness == found.contact_cells == ()
        and found.equal_accuracy is None
        and len(sentences(found)) == 2
    )
    assert {item.unit for item in found.quantities} == {"deg/s", "m/s"}


def test_unknown_condition_is_refused_before_anything_runs(study, asked):
    with pytest.raises(SceneError, match="phi99"):
        convergence.run(study, ConvergenceOptions("phi99"))
    assert asked == []


def test_stored_result_counts_only_while_nothing_changed(study):
    assert convergence.STAGE.stored(study) is None
    found = convergence.run(study, ConvergenceOptions("phi60"))
    assert convergence.STAGE.stored(study) == found
    assert convergence.STAGE.stored(Study(study.scene, study.folder, Settings())) is None


def test_page_shows_figure_and_sentences(finished):
    study, written = finished
    found, page = written.result, page_of(study, written)
    shown = document.html(convergence_page.draw(found), page.figure)
    assert 'id="chart-convergence"' in shown
    assert all(f"{inline(line[1:])}." in shown for line in sentences(found))
    assert study.path("figures/convergence.png").is_file()


def test_page_without_a_settled_run_has_no_figure(study, asked):
    asked.failing = {"phi15-4mm": "jammed"}
    written = convergence.run(study)
    page = page_of(study, written)
    shown = document.html(convergence_page.draw(written.result), page.figure)
    assert "GCI" in shown and "chart-convergence" not in shown and page.pictures == []


def test_report_takes_up_a_study_that_is_there(study, monkeypatch):
    shown = [item for item in registry.results() if item.stored is not None]
    monkeypatch.setattr(report, "results", lambda: shown)
    undrawn(monkeypatch)
    page = study.path("report.html")
    report.run(study)
    assert 'id="convergence"' not in page.read_text()
    convergence.run(study)
    report.run(study)
    assert 'id="convergence"' in page.read_text() and 'href="#convergence"' in page.read_text()
