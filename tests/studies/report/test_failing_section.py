"""A section, a result or a figure that fails leaves the others, and the command exits with 1."""

import re

import pytest
import typer
from markupsafe import Markup

from tests.studies.shown import STAGES
from tipoff import scenes
from tipoff.faults import Fault, SceneError
from tipoff.studies import registry
from tipoff.studies.commands.running import Output, guarded
from tipoff.studies.question import Result
from tipoff.studies.render import document
from tipoff.studies.report import assembly, stage
from tipoff.studies.report.page import Page
from tipoff.studies.runs.figures import Runs
from tipoff.studies.runs.thrust_facts import thrust_facts
from tipoff.studies.single import single
from tipoff.workspace.errors import StudyError
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

CURVES = {
    "three points": "0,0\n0.0045,30000\n0.009,0\n",
    "constant": "0,100\n0.05,100\n0.1,100\n0.15,100\n",
    "spring": "0,3000\n0.01,2000\n0.02,1000\n0.03,0\n",
    "trapezoid": "0,0\n0.003,1000\n0.1,1000\n0.103,0\n",
}


@pytest.fixture
def quick(monkeypatch):
    """Pages without figures."""
    monkeypatch.setattr(Page, "figure", lambda *_: Markup())


def page(folder, scene=None):
    return Page(scene or scenes.load("tiny"), folder, {}, Runs({}, {}), {})


def broken(_):
    raise ZeroDivisionError("float division by <zero>")


@pytest.mark.parametrize("anchor", [item.anchor for item in registry.sections()])
def test_each_section_may_fail_alone(anchor, tmp_path, monkeypatch, quick, capsys):
    sections = [
        item._replace(draw=broken if item.anchor == anchor else lambda _: ["I am drawn."])
        for item in registry.sections()
    ]
    monkeypatch.setattr(assembly, "sections", lambda: sections)
    made = page(tmp_path)
    html = assembly.render(made)
    assert html.count("I am drawn.") == len(sections) - 1
    assert made.failures == {anchor: "ZeroDivisionError: float division by <zero>"}
    assert f'<section id="{anchor}">' in html and "This section failed: ZeroDivision" in html
    assert "by &lt;zero&gt;" in html and "by <zero>" not in html
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["answer.draw", "inputs.scene_tables", "promises", "versions"])
def test_the_frame_may_fail_too(name, tmp_path, monkeypatch, quick):
    """The answer, the inputs, the promises and the origin, which are no studies."""

    def fails(*_):
        raise KeyError(name)

    monkeypatch.setattr(f"tipoff.studies.report.assembly.{name}", fails)
    made = page(tmp_path)
    html = assembly.render(made)
    assert len(made.failures) == 1
    assert all(f'id="{anchor}"' in html for anchor in ("answer", "scene", "colophon", "promises"))


def test_ctrl_c_is_no_failed_section(tmp_path, monkeypatch, quick):
    def stops(_):
        raise KeyboardInterrupt

    (first, *_) = registry.sections()
    monkeypatch.setattr(assembly, "sections", lambda: [first._replace(draw=stops)])
    with pytest.raises(KeyboardInterrupt):
        assembly.render(page(tmp_path))


@pytest.mark.parametrize("curve", CURVES)
def test_a_thrust_that_no_gaussian_fits_has_its_section(curve, tmp_path, quick):
    file = tmp_path / "curve.csv"
    file.write_text(f"time_s,force_N\n{CURVES[curve]}")
    table = {"kind": "measured", "file": str(file), "arm": 0.1}
    scene = scenes.load("tiny").replace({"thrust": table})
    assert any("Gaussian fit" in row[0] for row in thrust_facts(scene).rows)
    made = page(tmp_path, scene)
    assert 'id="thrust"' in assembly.render(made) and not made.failures


def test_a_failed_result_leaves_the_page_and_exits_with_1(tmp_path, monkeypatch, quick, capsys):
    results = [
        Result("mesh", broken),
        Result("flight", None, lambda _: broken(_)),
        Result("limits", broken, lambda _: None),
    ]
    monkeypatch.setattr(stage, "results", lambda: results)
    study = Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
    with pytest.raises(typer.Exit) as caught:
        guarded(lambda: Output(stage.run(study, every=True), None, tmp_path))
    assert caught.value.exit_code == 1
    said, html = capsys.readouterr().err, study.path("report.html").read_text()
    for name in ("mesh", "flight", "limits"):
        assert f"{name}: ZeroDivisionError" in said and f"{name}: ZeroDivisionError" in html


def refused(_):
    raise SceneError([Fault("own", "agreement.fitted", "nothing", "a condition")])


def test_a_result_that_the_scene_does_not_allow_leaves_the_page(
    tmp_path, monkeypatch, quick, capsys
):
    """Control: where it is the first, nothing is lost and the command ends with 2."""
    study = Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
    page = study.path("report.html")

    def made(_):
        found = {"key": "k", "conditions": [], "failed": []}
        study.path("highfi.json").parent.mkdir(exist_ok=True)
        study.path("highfi.json").write_text("{}")
        return STAGES["highfi"].made(found)

    for names, code in ((["calibration", "highfi"], 2), (["highfi", "calibration"], 1)):
        listed = [Result(name, made if name == "highfi" else refused) for name in names]
        monkeypatch.setattr(stage, "results", lambda listed=listed: listed)
        with pytest.raises(typer.Exit) as caught:
            guarded(lambda: Output(stage.run(study), None, tmp_path))
        assert caught.value.exit_code == code and page.exists() == (code == 1)
    assert "calibration: 1 fault in the scene" in capsys.readouterr().err
    assert "agreement.fitted: given nothing" in page.read_text()


def test_a_scene_without_conditions_to_compare_has_a_page_without_faults(
    tmp_path, monkeypatch, quick, capsys
):
    """Its page began with three faults about agreement.fitted, and the command ended with 1."""
    alone = {"agreement.fitted": [], "agreement.held_out": [], "conditions": None}
    scene = scenes.load("tiny").replace({"agreement.floor": [], "agreement.refined": []} | alone)
    study = Study(scene, tmp_path / "tiny", defaults("tiny"))
    comparing = [
        item
        for item in registry.results()
        if item.name in ("calibration", "agreement", "cost_study")
    ]

    def made(_):
        study.path("highfi.json").parent.mkdir(exist_ok=True)
        study.path("highfi.json").write_text("{}")
        return STAGES["highfi"].made({"key": "k", "conditions": [], "failed": []})

    monkeypatch.setattr(stage, "results", lambda: [Result("highfi", made), *comparing])
    found, html = stage.run(study), study.path("report.html").read_text()
    assert len(comparing) == 3 and found["failed"] == [] and "agreement.fitted" not in html
    assert re.search(r"Not made: [^.]*\bcalibrate\b", html)
    assert capsys.readouterr().err.count("since the scene has no [agreement]") == 3


def test_figures_that_fail_lose_no_result(tmp_path):
    found, files = document.with_figures({"rate": 1.0}, broken, tmp_path)
    assert found["rate"] == 1.0 and files == []
    assert found["failed"] == ["figures: ZeroDivisionError: float division by <zero>"]


def test_text_that_fails_leaves_the_files_and_exits_with_1(tmp_path, capsys):
    result = {"stage": "mesh", "scene": "tiny"}
    with pytest.raises(typer.Exit) as caught:
        guarded(lambda: Output(result, broken, tmp_path))
    assert caught.value.exit_code == 1 and "mesh.json" in capsys.readouterr().out


def test_a_condition_that_fails_leaves_the_others():
    def make(name):
        return broken(name) if name == "b" else {"condition": name, "failed": []}

    found = single.several(["a", "b", "c"], make)
    assert [row["condition"] for row in found["conditions"]] == ["a", "c"]
    assert found["failed"] == ["b: ZeroDivisionError: float division by <zero>"]

    def refuses(name):
        raise StudyError("rejected")

    with pytest.raises(StudyError):
        single.several(["a", "b"], refuses)
