"""The parts of the report: provenance of every value, notices, charts drawn twice, no use of a
network."""

import re
from dataclasses import asdict, replace

import numpy as np
import pytest

from tests.studies.agreement import made as agreement
from tests.studies.calibration.test_page import FIT
from tests.studies.cost.made import cost, point
from tests.studies.shown import Documents, html
from tests.studies.synthetic import COSTS, flight
from tipoff import scenes
from tipoff.studies import registry
from tipoff.studies.agreement import other_rails, verdicts
from tipoff.studies.agreement.page import starred
from tipoff.studies.cost.page import picture as cost_picture
from tipoff.studies.limits import stage as limiting
from tipoff.studies.populations import exceedance
from tipoff.studies.render.chart import Chart, Line, Panel, to_files
from tipoff.studies.render.table import Table, markdown, number
from tipoff.studies.report import inputs, stage
from tipoff.studies.report.assembly import render
from tipoff.studies.report.page import Page
from tipoff.studies.report.promises import promises
from tipoff.studies.runs import figures
from tipoff.studies.runs.figures import Runs
from tipoff.studies.runs.stage import row
from tipoff.workspace import machine
from tipoff.workspace.errors import StudyError
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study
from validation import montecarlo as evidence
from validation.montecarlo import stage as montecarlo


@pytest.mark.parametrize(
    "value, unit, shown",
    [
        (2.5e-4, "m", "250 µm"),
        (7.2e10, "Pa", "72 GPa"),
        (np.pi / 180, "rad", "1 deg"),
        (0.0, "m", "0 m"),
        (0.33, "dimensionless", "0.33"),
        (9.9, "kg", "9.9 kg"),
        ((0.35, 0.2), "m", "350 mm, 200 mm"),
        ((), "m", "none"),
        (("bolts", "part 2"), "", "bolts, part 2"),
    ],
)
def test_values_are_shown_in_readable_units(value, unit, shown):
    assert inputs.readable(value, unit) == shown


def test_every_number_of_the_scene_is_listed_with_unit_and_provenance():
    scene = scenes.load("reference")
    found = {key: (value, unit) for key, value, unit, _ in inputs.values(scene)}
    assert found["contact.clearance"] == (0.25e-3, "m")
    assert found["thrust.peak"] == (6000.0, "N")
    assert found["rail.mounts.1.start"] == (0.1, "m")
    numbers = [key for key, (value, unit) in found.items() if isinstance(value, float) and not unit]
    assert numbers == ["contact.stiffness"]  # its unit depends on the exponent
    assert inputs.provenance(scene, "payload.inertia.xy", True).startswith("assumed: box")
    assert inputs.provenance(scene, "rail.material.density", True) == "paper"
    assert inputs.provenance(scene, "output.interval", False) == "default"
    assert "not stated" not in {
        inputs.provenance(scene, key, stated)
        for key, _, _, stated in inputs.values(scene)
        if key.split(".")[0] in ("payload", "platform", "rail", "friction", "thrust_offset")
    }


@pytest.mark.parametrize("name", scenes.catalog())
def test_every_scene_of_the_catalogue_is_listed(name):
    """Some have empty lists, such as the holes of a section."""
    table = inputs.scene_tables(scenes.load(name))[0]
    assert {"`payload.mass`", "`rail.material.density`"} <= {row[0] for row in table.rows}


def test_what_a_scene_says_of_a_mesh_file_is_listed():
    """Names of groups, which are no tables, and boxes, which are."""
    box = [{"low": ["0 m", "0 m", "0 m"], "high": ["1 mm", "2 mm", "0 m"]}]
    rail = scenes.load("channel").rail.model_dump()
    keys = {"unit": "mm", "axes": ("y", "z", "x"), "body": "rails"}
    keys |= {"groups": {"mount": ["bolts", "part 2"]}, "surfaces": {"contact": box}}
    scene = scenes.load("channel").replace({"rail": rail | keys})
    found = {key: inputs.readable(value, unit) for key, value, unit, _ in inputs.values(scene)}
    assert found["rail.groups.mount"] == "bolts, part 2"
    assert found["rail.surfaces.contact.0.high"] == "1 mm, 2 mm, 0 m"
    assert (found["rail.unit"], found["rail.axes"]) == ("mm", "y, z, x")


def test_text_from_a_scene_is_escaped(tmp_path):
    scene = scenes.load("tiny").replace({"description": "<script>alert(1)</script>"})
    page = Page(scene, tmp_path, {}, Runs({}, {}, {}), {})
    assert "<script>alert" not in render(page)
    assert "&lt;b&gt;" in html([Table(("a",), [("<b>",)])])


def test_a_star_leaves_powers_of_ten_as_they_are():
    assert "1·10<sup>-9</sup>*</td>" in html([Table(("a",), [(starred(number(1e-9), False),)])])
    assert starred(number(0.5), True) == "0.5"


def test_a_chart_is_the_same_in_its_files_and_on_the_page(tmp_path):
    """A long smooth curve takes no more room than its shape needs, and texts stay texts."""
    x = np.linspace(0.0, 1.0, 100_000)
    chart = Chart(
        "twice",
        [
            Panel("left", "x", "y", [Line(x, x**2, "square")]),
            Panel(
                "right",
                "x",
                "y",
                [Line([1.0, 10.0], [1e-3, 1e-2], "points", marker="o", labels=("a", "b"))],
                True,
                (2e-3, "band"),
            ),
        ],
        columns=2,
    )
    page = Page(scenes.load("tiny"), tmp_path, {}, Runs({}, {}, {}), {})
    shown = page.figure(chart, 'a "square" & <points>')
    assert 'id="chart-twice"' in shown and ">square<" in shown and len(shown) < 60_000
    assert 'aria-label="a &quot;square&quot; &amp; &lt;points&gt;"' in shown
    png, svg = page.pictures
    drawn = svg.read_bytes()
    assert png.read_bytes()[:4] == b"\x89PNG" and b"<svg" in drawn
    assert to_files(chart, tmp_path)[1].read_bytes() == drawn
    made = machine.state()
    assert machine.stated(made) in svg.read_text() and machine.stated(made) in shown
    other = to_files(chart, tmp_path, made | {"commit": "0123456789ab"})[1].read_text()
    assert "0123456789ab" in other and machine.stated(made) not in other


def test_page_of_a_reference_alone_names_the_targets_that_make_the_rest(tmp_path, figures):
    scene = scenes.load("tiny")
    runs = {
        name: flight(lambda t: np.outer(np.sin(100.0 * t), [0.1, 0.2, 0.3]))
        for name in ("phi15", "phi60")
    }
    rows = [
        row(name, run, f"highfi/{name}.nc")
        for name, run in runs.items()
        if run.cost.update(elements=1, ns_per_element_step=1.0, ns_per_element_stepped=None) is None
    ]
    other = other_rails.Scene("thin", agreement.table(), {})
    made = Page(
        scene,
        tmp_path,
        Documents(
            highfi={"key": "k", "conditions": list(map(asdict, rows)), "failed": []}, rails=[other]
        ),
        Runs(runs, {}, {}),
        {"calibration": "phi15 diverged"},
    )
    page = render(made)
    assert 'id="rails"' in page and "0 of 0" in page
    line = re.search(r"Not made: ([^.]*)\. <code>([^<]*)</code>", page)
    assert {"view --mesh", "compare", "cost", "ablation"} <= set(line[1].split(", "))
    assert line[2] == f"tipoff NAME --scene tiny --out {tmp_path.parent}"
    assert "phi15 diverged" in page
    assert "docs/verification_and_validation.md" in page
    assert (tmp_path / "figures" / "figure6.png").is_file()
    # One page, no network: nothing is fetched from anywhere. The library itself mentions addresses,
    # so only tags count.
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=[\"']?(?:https?:)?//", page)


def test_broken_promise_is_called_broken():
    run = flight(
        checks={
            "linear_momentum_error": 1e-9,
            "angular_momentum_error": 1e-13,
            "friction_power_max": 0.0,
        },
        cost=COSTS | {"dt_limit_s": 2e-6},
    )
    found = {item.text: item for item in promises({"highfi": [row("phi15", run, "")], "lowfi": []})}
    assert found["linear momentum of the free system, finite elements"].kept is False
    assert found["angular momentum, finite elements"].kept is True
    assert found["no step above the critical one, finite elements"].kept is True
    assert found["total energy ledger, finite elements"].kept is False  # not reported is not kept


def promised(rows, *others):
    return {item.text.split(";")[0]: item for item in promises(rows, *others)}


def test_a_promise_is_kept_only_by_runs_that_keep_it():
    """No run keeps nothing, a diverged one breaks, and a NaN is found. Control: a sound run keeps it."""
    name, sound = "no NaN leaves the program", row("phi15", flight(cost=COSTS), "")
    lost = replace(sound, status="diverged", settled=None)
    late = replace(sound, status="time_limit", settled=None)
    jam = replace(sound, status="jammed", settled=None)
    wild = replace(sound, settled=replace(sound.settled, rate_deg_s=(0.0, float("nan"), 0.0)))
    for rows, kept in (
        ([], None),
        ([lost], False),
        ([sound, late], False),
        ([sound, wild], False),
        ([sound, jam], True),
        ([sound], True),
    ):
        assert promised({"highfi": rows, "lowfi": []})[name].kept is kept
    worst = promised({"highfi": [sound, late], "lowfi": []})[name].worst
    assert worst == "1 of 2 runs ended well, not phi15 time_limit"
    assert "0 of 1 run ended well" in promised({"highfi": [lost], "lowfi": []})[name].worst


def test_a_check_that_one_run_does_not_report_is_not_kept():
    """Nor is one that is no number in one run. Control: all of them report a small error."""
    name = "linear momentum of the free system, finite elements"

    def found(*errors):
        one = row("phi15", flight(cost=COSTS), "")
        rows = [replace(one, checks={"linear_momentum_error": error}) for error in errors]
        return promised({"highfi": rows, "lowfi": []})[name].kept

    assert found(1e-13, 1e-13) and not found(1e-13, None) and not found(float("nan"), 1e-13)


def test_bits_are_the_same_only_where_repeats_were_compared():
    """One run of each model has no repeat. Control: two have one."""
    for repeats, same, kept in ((1, None, None), (1, True, None), (2, True, True)):
        speed = replace(
            agreement.SPEEDUP,
            repeats_identical=same,
            highfi_repeats=repeats,
            lowfi_repeats=repeats,
        )
        found = promised({"highfi": [], "lowfi": []}, agreement.table(speedup=speed))
        assert found["same input, same bits"].kept is kept


def test_agreement_on_held_out_conditions_is_given_where_one_is_judged():
    for words, kept in (([verdicts.CANNOT], False), ([verdicts.CANNOT, verdicts.MISSES], True)):
        held_out = tuple(replace(agreement.ROW, judgement=word) for word in words)
        found = promised({"highfi": [], "lowfi": []}, agreement.table(held_out=held_out), FIT)
        assert found["calibration reports its information matrix and weak directions"].kept is kept
    found = promised({"highfi": [], "lowfi": []}, None, FIT)
    assert found["calibration reports its information matrix and weak directions"].kept is None


def test_figures_of_one_condition():
    scene = scenes.load("tiny")
    force = np.zeros((601, 16, 3))
    force[100:200, 2, 1] = 50.0
    runs = Runs({"phi15": flight(pad_force=force)}, {}, {"phi15": flight()})
    assert [panel.title for panel in figures.contact_forces(scene, runs, "phi15").panels] == [
        "pad 2 at x -80, y -100, z 100 mm"
    ]
    panels = figures.figure6(runs, ["phi15"]).panels
    assert [len(panel.lines) for panel in panels] == [2 + 5, 1, 6, 3]
    assert not any(
        line.y.any() for panel in panels[1::2] for line in panel.lines
    )  # the same flight


def judged(condition, l2, settled, **others):
    errors = {"rate_relative_l2": l2, "settled_rate_error_deg_s": settled}
    return replace(agreement.ROW, condition=condition, **errors, **others)


def test_other_rails_are_judged_where_a_pad_touches_and_the_reference_is_converged():
    compared = agreement.table(
        fitted=(judged("phi15", 0.05, 0.2),),
        held_out=(judged("h1", 0.12, 0.3, judgement=verdicts.MISSES),),
        compliant=(
            judged("phi15", 0.003, 0.01),
            judged("h1", 0.005, 0.02),
            judged("h5", 0.9, 9.0, touches=False),
            judged("h8", 0.8, 8.0, judgement=verdicts.CANNOT),
            judged("h9", None, None, judgement=verdicts.MISSES),
            judged("h7", 0.7, 7.0, judged_as="distribution", judgement=verdicts.AS_DISTRIBUTION),
        ),
        element_size_m=4e-3,
    )
    scene = other_rails.Scene("thin", compared, {"contact.stiffness": 2e7})
    table, constants = other_rails.parts([scene])
    springs, compliant = table.rows
    assert springs == ("thin", 4e-3, "springs, calibrated", "2 of 2", 1, 0, 0.12, 0.3, "")
    assert compliant == ("thin", 4e-3, "compliant", "4 of 5", 2, 1, 0.005, 0.02, "h8")
    assert "| thin | 4 | compliant | 4 of 5 | 2 | 1 | 0.5 | 0.02 | h8 |" in markdown(table)
    assert constants.rows == [("thin", "stiffness 2e+07")]


def test_pareto_front_counts_errors_below_the_band_as_the_band():
    def measured(model, error, wall, pareto):
        return point(
            model=model,
            rung="highfi" if model == "mesh" else model,
            error_deg_s=error,
            curve_error=error and 0.1 * error,
            wall_s=wall,
            reference=error is None,
            pareto=pareto,
        )

    points = [
        measured("rough", 0.3, 1e-3, True),
        measured("fine", 0.01, 5e-3, True),
        measured("mesh", None, 9.0, False),
    ]
    chart = cost_picture(cost(points, 0.04))
    settled, curves = chart.panels
    assert [line.name for line in settled.lines] == [
        "Pareto front",
        "recommended: fine, -",  # 0.01 is within 0.1 deg/s, 0.3 is not
        "rough",
        "fine",
        "mesh",
    ]
    # curves carry the name of their model
    assert [line.labels for line in settled.lines[2:4]] == [("rough",), ("fine",)]
    assert (settled.lines[0].x, settled.lines[0].y) == (
        [1e-3, 5e-3, 5e-3, 9.0],
        [0.3, 0.3, 0.04, 0.04],
    )
    assert settled.lines[4].y == [0.04] and [line.name for line in curves.lines] == [
        "rough",
        "fine",
    ]
    assert curves.lines[0].y == pytest.approx([3.0])


def test_a_study_the_scene_gives_no_occasion_for_stops_nothing(tmp_path, monkeypatch):
    """A scene that says nothing of a flight. Control: without being asked for, it is a target that
    is named."""
    flight_alone = [item for item in registry.results() if item.name == "flight"]
    monkeypatch.setattr(stage, "results", lambda: flight_alone)
    study = Study(
        scenes.load("tiny").replace({"flight": None}), tmp_path / "tiny", defaults("tiny")
    )
    page = study.path("report.html")
    stage.run(study)
    assert re.search(r"Not made: [^.]*\bflight\b", page.read_text())
    found = stage.run(study, every=True)
    assert (
        found["failed"] == []
        and not re.search(r"Not made: [^.]*\bflight\b", page.read_text())
        and "[flight]" in page.read_text()
    )


def test_limits_of_the_report_are_those_of_the_studies_that_it_makes(tmp_path, monkeypatch):
    """Control: without a limit each study has its own default."""
    asked = {}
    for name, owner in {"limits": limiting, "montecarlo": montecarlo}.items():

        def run(study, options=None, name=name):
            asked[name] = options and options.limits
            raise StudyError("not made here")

        monkeypatch.setattr(owner, "run", run)
    monkeypatch.setattr(registry, "ADDED", [evidence.ENTRY])
    mine = [item for item in registry.results() if item.name in ("limits", "montecarlo")]
    monkeypatch.setattr(stage, "results", lambda: mine)
    study = Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
    given = exceedance.limits(["x=2 deg/s", "0.1 rad/s"])
    stage.run(study, every=True, limits=given)
    assert set(asked) == {"limits", "montecarlo"}
    for texts in asked.values():
        assert exceedance.limits(texts) == given
    stage.run(study, every=True)
    assert asked == {"limits": None, "montecarlo": None}
