"""What is written for other codes, and what is said of one that is missing."""

import importlib.util
import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from tipoff.faults import SceneError
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets, read
from tipoff.meshes import bricks
from tipoff.scenes import load
from tipoff.studies.render import document
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, StudyError
from validation.peers import (
    calculix,
    calculix_impact,
    command,
    exudyn_model,
    impact_problem,
    page,
    quadratic,
    springs_cases,
    springs_problem,
    stage,
)
from validation.peers.case import Case, Peer, PeerMissing, Unfinished, require_ours

LINES = [np.array([0.0, 1.0, 3.0]), np.array([0.0, 1.0]), np.array([0.0, 2.0])]


@pytest.fixture(scope="module")
def two_bricks() -> RailMesh:
    points, cells = bricks.filled(LINES, np.ones((2, 1, 1), dtype=bool))
    return RailMesh(points, cells, {"all": boundary_facets(cells)})


@pytest.fixture(scope="module", params=[8e-3, pytest.param(4e-3, marks=pytest.mark.slow)])
def size_and_bar(request) -> tuple[float, quadratic.Bar]:
    return request.param, quadratic.bar(request.param)


@pytest.mark.parametrize("kind", [calculix.LINEAR, calculix.QUADRATIC])
def test_sides_of_elements_are_the_facets_of_the_mesh(two_bricks, kind):
    of = calculix.solid(two_bricks, kind)
    facets = two_bricks.surfaces["all"]
    _, _, nodes = calculix.sides(of, facets)
    np.testing.assert_array_equal(np.sort(nodes[:, :4]), np.sort(facets))
    weight = calculix.shares(nodes)
    assert weight.sum() == pytest.approx(1.0)
    middle = of.points[facets].mean(axis=1)
    np.testing.assert_allclose(np.einsum("mni,n->mi", of.points[nodes], weight), middle)


def test_middle_nodes_lie_between_their_corners_and_are_shared(two_bricks):
    of = calculix.solid(two_bricks, calculix.QUADRATIC)
    # 12 corners and 20 edges
    assert len(of.points) == 32 and len(np.unique(of.points, axis=0)) == 32
    corners, middles = of.points[of.cells[:, :8]], of.points[of.cells[:, 8:]]
    # edges of the lower side, of the upper one, and upwards
    np.testing.assert_allclose(middles[:, 0], corners[:, :2].mean(axis=1))
    np.testing.assert_allclose(middles[:, 7], corners[:, [7, 4]].mean(axis=1))
    np.testing.assert_allclose(middles[:, 8], corners[:, [0, 4]].mean(axis=1))


def test_a_deck_has_16_numbers_a_line_and_20_digits_a_number(two_bricks):
    of = calculix.solid(two_bricks, calculix.QUADRATIC)
    deck = calculix.head(of, (2810.0, 72e9 / 7.0, 1.0 / 3.0))
    deck += calculix.held(of, two_bricks.surfaces["all"])
    fields = [line.split(",") for line in deck.splitlines() if not line.startswith("*")]
    assert max(map(len, fields)) <= 17  # a line that is continued ends with a comma
    assert max(len(word) for words in fields for word in words) <= 20


TABLE = (
    " displacements (vx,vy,vz) for set A and time  {}\n\n  1  1.5E-01 2.0E+00\n  2  3.0 {}\n\n x\n"
)


def test_tables_are_read_by_their_titles():
    answer = calculix.Answer(TABLE.format("1.0", "4.0"), 0.0)
    found = answer.table("displacements", 2, 1.0)
    np.testing.assert_array_equal(found, [[1, 0.15, 2.0], [2, 3.0, 4.0]])


@pytest.mark.parametrize(
    "time, last, title, rows, words",
    [
        ("1.0", "4.0", "stresses", 2, "printed no stresses"),
        ("1.0", "4.0", "displacements", 3, "has 2 rows of displacements, asked were 3"),
        ("0.5000000E+00", "4.0", "displacements", 2, "ended at 0.5 s, asked was 1 s"),
        ("unknown", "4.0", "displacements", 2, "ended at nan s"),
        ("1.0", "NaN", "displacements", 2, "values that are not finite"),
    ],
)
def test_a_table_of_a_run_that_did_not_finish_is_refused(time, last, title, rows, words):
    with pytest.raises(Unfinished, match=words):
        calculix.Answer(TABLE.format(time, last), 0.0).table(title, rows, 1.0)


@pytest.mark.parametrize(
    "script, words",
    [
        ("echo ' Job finished'; touch job.dat; exit 1", "exit code 1"),
        ("echo ' Job finished'", "exit code 0"),
        ("touch job.dat; echo ' STEP 1'", "STEP 1"),
        ("touch job.dat; echo '*ERROR in u_calloc'; echo ' Job finished'", "u_calloc"),
    ],
    ids=["exit code", "no result", "no end", "error"],
)
def test_a_program_that_does_not_finish_is_refused_in_words(tmp_path, monkeypatch, script, words):
    """Control: the same program that finishes."""
    program = tmp_path / "ccx"
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    for text in (script, "echo ' Job finished'; echo x > job.dat"):
        program.write_text(f"#!/bin/sh\n{text}\n")
        program.chmod(0o755)
        if text == script:
            with pytest.raises(Unfinished, match=words):
                calculix.run("deck")
    assert calculix.run("deck").text == "x\n"


@pytest.mark.parametrize(
    "theirs, words",
    [
        ({"force": 1.0}, "no speed"),
        ({"force": 1.0, "speed": float("nan"), "cpu_s": 1.0}, "not finite"),
        ({"force": 1.0, "speed": 2.0, "cpu_s": 0.0}, "times of 1 s and 0 s"),
    ],
)
def test_a_peer_that_did_not_do_what_was_asked_ends_the_study_in_words(monkeypatch, theirs, words):
    units = {"force": "N", "speed": "m/s"}
    case = Case(
        name="made-up",
        title="A case",
        inputs=dict,
        matched="",
        unmatched="",
        settings=("one",),
        units=units,
        ours=lambda setting: {"force": 1.0, "speed": 2.0, "cpu_s": 1.0},
        theirs=lambda setting: theirs,
        within=lambda setting, quantity: 0.1,
    )
    peer = Peer("Scales", "a balance", lambda: "1", lambda: (case,))
    monkeypatch.setattr(stage, "PEERS", (peer,))
    with pytest.raises(StudyError, match=f"A case: .*{words}"):
        stage.run(Path("nowhere"))


def test_our_runs_end_where_they_were_asked_to():
    run = SimpleNamespace(status="exited", message="", time=np.array([0.0, 0.04]))
    require_ours(run, "exited", 0.04)
    for wrong in ({"status": "diverged"}, {"message": "a promise is broken"}, {"time": [0.03]}):
        with pytest.raises(Unfinished):
            require_ours(SimpleNamespace(**vars(run) | wrong), "exited", 0.04)


def test_a_missing_code_is_a_row_that_says_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    (row,) = stage.run(tmp_path, ["CalculiX"])["peers"]
    assert row["peer"] == "CalculiX" and "apt-get install calculix-ccx" in row["missing"]
    assert not (tmp_path / "peers").exists()
    said = document.terminal(page.parts([row]))
    assert "missing" in said and "apt-get" in said


def test_the_command_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    app = typer.Typer()
    app.command()(command.peers)
    found = CliRunner().invoke(app, ["calculix", "--out", str(tmp_path)])
    assert found.exit_code == 0 and "missing" in found.output
    assert CliRunner().invoke(app, ["abaqus"]).exit_code == 2


def test_the_section_shows_what_was_run(tmp_path):
    """The kept results stand on the page of a folder that has them, and the page is empty without."""
    study = Study(load("tiny"), tmp_path / "tiny", defaults("tiny"))
    assert page.stored(study) is None
    shutil.copytree(stage.KEPT, tmp_path / "peers")
    found = page.stored(study)
    parts = page.parts(found["peers"])
    said = document.markdown(parts)
    assert "h10" in said and "Time at equal error" in said
    (chart,) = (part.chart for part in parts if isinstance(part, document.Figure))
    assert len(chart.panels) == 4 and all(len(panel.lines) >= 2 for panel in chart.panels)


def test_unknown_codes_are_bad_input(tmp_path):
    with pytest.raises(SceneError, match="(?s)'abaqus'.*'adams'.*CalculiX, scikit-fem"):
        stage.run(tmp_path, ["abaqus", "Exudyn", "adams"])


@pytest.mark.skipif(importlib.util.find_spec("exudyn") is not None, reason="exudyn is installed")
def test_a_missing_package_names_the_extra():
    with pytest.raises(PeerMissing, match="tipoff\\[peers\\]"):
        exudyn_model.version()


@pytest.mark.parametrize(
    ("depth", "closing", "force"),
    # VERIFICATION: the paper's pad, mm and mm/s
    [(0.05, 0.0, 782.624), (0.10, 20.0, 2524.705), (0.30, 20.0, 12702.174), (0.01, -400.0, 0.0)],
)
def test_the_user_function_is_impact(depth, closing, force):
    law = exudyn_model.Law(7e4 * 1e3**1.5, 1.5, 6e4, 3e-4, 0.0, 0.01)
    wrench = exudyn_model.Wrench(springs_problem.problem("phi35", "impact", True), law)
    found = wrench.force(
        1e-3 * depth, np.array([0.0, 1.0, 0.0]), np.array([3.0, 1e-3 * closing, 0])
    )
    np.testing.assert_allclose(found, [0.0, -force, 0.0], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(("speed", "share"), [(0.005, 0.6875), (0.01, 1.0), (3.0, 1.0)])
def test_the_user_function_has_the_friction_of_the_scene(speed, share):
    law = exudyn_model.Law(1e7, 1.0, 0.0, None, 0.2, 0.01)
    wrench = exudyn_model.Wrench(springs_problem.problem("phi35", "impact", True), law)
    found = wrench.force(1e-5, np.array([0.0, 0.0, -1.0]), np.array([speed, 0.0, 0.0]))
    np.testing.assert_allclose(found, [-share * 0.2 * 100.0, 0.0, 100.0], rtol=1e-12)


def test_both_bodies_of_exudyn_get_opposite_wrenches():
    """Momenta about one point are kept: thrust, two pressed pads and friction."""
    problem = springs_problem.problem("h4", "impact", True)
    wrench = exudyn_model.Wrench(problem, springs_cases.IMPACT)
    turn = np.array([[1.0, -2e-3, 0.0], [2e-3, 1.0, 0.0], [0.0, 0.0, 1.0]])
    payload = (np.array([0.01, 2e-4, 0.0]), turn, np.array([4.0, 0.02, 0.01]), np.zeros(3))
    platform = (
        np.array(problem.platform_place),
        np.eye(3),
        np.zeros(3),
        np.array([0.0, 0.01, 0.0]),
    )
    force, moment, back, turned = wrench.at(0.012, payload, platform)
    assert np.abs(force[1:]).max() > 10.0
    np.testing.assert_allclose(back, -force, atol=1e-9)
    total = moment + np.cross(payload[0], force) + turned + np.cross(platform[0], back)
    np.testing.assert_allclose(total, 0.0, atol=1e-9)


def test_the_mean_over_the_window_of_a_line_is_its_middle():
    time = np.linspace(0.0, 0.01, 7)
    rate = np.column_stack([time, 2.0 * time, 0.0 * time])
    found = springs_problem.settled(time, rate, 0.004)
    np.testing.assert_allclose(found, np.rad2deg([0.005, 0.01, 0.0]))


def test_the_block_of_calculix_has_the_mass_and_inertia_of_the_case():
    block = calculix_impact.block()
    assert block.mass.sum() == pytest.approx(impact_problem.MASS)
    size = np.ptp(block.points, axis=0)
    inertia = impact_problem.MASS * (size[0] ** 2 + size[2] ** 2) / 12.0
    assert inertia == pytest.approx(impact_problem.INERTIA, rel=1e-9)
    assert read(impact_problem.bar(4e-3)).surfaces["contact_z"].shape == (108, 4)


def test_the_quadratic_bar_has_its_mass_and_bends_as_a_beam_with_shear(size_and_bar):
    """Simpson's weights sum to the mass between the clamps; Timoshenko between two clamps under a load
    at the middle: F L^3 / (192 E I) + F L / (4 kappa G A), and what the clamps of a solid add."""
    size, bar = size_and_bar
    length, width, depth = impact_problem.LENGTH, impact_problem.WIDTH, impact_problem.DEPTH
    held = size / 6.0 / length  # half of Simpson's end weight on either side
    mass = impact_problem.DENSITY * length * width * depth * (1.0 - 2.0 * held)
    assert (1.0 / bar.inverse_mass).sum() == pytest.approx(3.0 * mass, rel=1e-12)
    from scipy.sparse.linalg import spsolve

    line = bar.across[bar.x.size // 2]
    load = np.zeros(bar.inverse_mass.size)
    load[line] = 1.0 / line.size
    moved = spsolve(bar.stiffness.tocsc(), load)
    modulus, shear = (
        impact_problem.MODULUS,
        0.5 * impact_problem.MODULUS / (1.0 + impact_problem.RATIO),
    )
    beam = length**3 / (192.0 * modulus * width * depth**3 / 12.0)
    beam += length / (4.0 * 5.0 / 6.0 * shear * width * depth)
    assert moved[line].mean() == pytest.approx(beam, rel=0.12)
    # no contact, no load
    pad = quadratic.Pad(bar, impact_problem.STIFFNESS)
    force, load = pad.press(
        np.array([0.0, impact_problem.HEIGHT + 1e-6, 0.0]), np.zeros(3), 0.0 * load, 0.0 * load
    )
    assert not force.any() and not load.any()


def test_the_quadratic_pad_keeps_momentum_and_has_the_force_of_its_crown(size_and_bar):
    """Force of a crowned pad pressed by d into a flat wall: k times the integral of d - relief
    (xi^4 + eta^4) where that is positive, by scipy."""
    from scipy.integrate import dblquad

    _, bar = size_and_bar
    stiffness, depth = impact_problem.STIFFNESS, 5e-6
    still = np.zeros(bar.inverse_mass.size)
    pad = quadratic.Pad(bar, stiffness)
    place = np.array([0.0, impact_problem.HEIGHT - depth, 0.0])
    force, load = pad.press(place, np.array([5.0, 0.0, 0.0]), still, still)
    edge = (depth / impact_problem.RELIEF) ** 0.25
    exact, _ = dblquad(
        lambda eta, xi: depth - impact_problem.RELIEF * (xi**4 + eta**4),
        0.0,
        edge,
        0.0,
        lambda xi: max(0.0, edge**4 - xi**4) ** 0.25,
    )
    exact *= 4.0 * stiffness * (0.5 * impact_problem.PAD) ** 2
    assert force[1] == pytest.approx(exact, rel=3e-3)
    assert force[0] == pytest.approx(-0.2 * force[1], rel=1e-12)
    assert load[bar.across[bar.across >= 0]].sum() == pytest.approx(-force[1], rel=1e-12)
    assert load[bar.along[bar.along >= 0]].sum() == pytest.approx(-force[0], rel=1e-12)
