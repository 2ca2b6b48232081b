"""The model that an accuracy or a time calls for, from measured cost."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from tests.studies.agreement.made import ROW, table
from tests.studies.cost.made import cost, point
from tipoff import scenes
from tipoff.studies.agreement.candidates import Candidate
from tipoff.studies.agreement.stage import Simpler
from tipoff.studies.cli import app
from tipoff.studies.cost import stage as cost_stage
from tipoff.studies.cost.choice import choose, elsewhere
from tipoff.studies.cost.page import draw, recommended
from tipoff.studies.render.document import Notice
from tipoff.studies.single import single
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, StudyError

# name, error (deg/s), wall (s); None is the finest mesh, whose error bound is the band of 0.02.
POINTS = [
    ("rigid", 0.9, 0.002),
    ("rigid fine", 0.85, 0.004),
    ("compliant", 0.05, 0.003),
    ("compliant fine", 0.004, 0.006),
    ("4 mm", 0.03, 5.0),
    ("2 mm", None, 30.0),
    ("lost", 0.0, 0.001),
]


COST = cost(
    [
        point(
            model=name,
            rung="highfi" if "mm" in name else name.split()[0],
            setting=1e-3 * int(name[0]) if "mm" in name else 1e-6,
            error_deg_s=error,
            reference=error is None,
            wall_s=wall,
            status="diverged" if name == "lost" else "exited",
        )
        for name, error, wall in POINTS
    ],
    0.02,
)


@pytest.mark.parametrize(
    "accuracy, budget, expected",
    [
        (1.0, None, "rigid"),
        (0.1, None, "compliant"),
        (0.03, None, "compliant fine"),
        (0.02, None, "compliant fine"),
        (None, 0.003, "compliant"),
        (None, 0.0025, "rigid"),
        (None, 60.0, "compliant fine"),
        (0.1, 4.0, "compliant"),
        (0.86, 0.0025, None),
        (0.01, None, None),
        (None, 0.0015, None),
    ],
)
def test_cheapest_or_most_exact(accuracy, budget, expected):
    """An error below the band counts as the band: 0.004 deg/s cannot be told from 0.02. A model
    that diverged never counts."""
    if expected is None:
        with pytest.raises(StudyError, match="no model fits"):
            choose(COST, "phi15", None, accuracy, budget)
    else:
        found = choose(COST, "phi15", None, accuracy, budget)
        assert found.point.model == expected and expected in found.why
        assert found.why.endswith("on phi15")


def test_refusal_names_the_nearest():
    with pytest.raises(StudyError) as fault:
        choose(COST, "phi15", None, 0.1, 0.0025)
    assert "most accurate in this time: rigid, - (0.9 deg/s, 0.002 s)" in str(fault.value)
    assert "fastest with this accuracy: compliant, - (0.05 deg/s, 0.003 s)" in str(fault.value)


def test_refusal_of_one_limit_names_the_best_there_is():
    with pytest.raises(StudyError, match="most accurate: compliant fine, - "):
        choose(COST, "phi15", None, accuracy=0.01)
    with pytest.raises(StudyError, match="fastest: rigid, - "):
        choose(COST, "phi15", None, budget=0.0015)


def agreement(error, unsure):
    """Rows of two conditions: small errors on phi60, these on h8."""
    small = replace(
        ROW,
        condition="phi60",
        settled_rate_error_deg_s=0.01,
        reference_uncertainty_deg_s=0.01,
    )
    rows = (
        small,
        replace(
            small,
            condition="h8",
            settled_rate_error_deg_s=error,
            reference_uncertainty_deg_s=unsure,
        ),
    )
    simpler = tuple(
        Simpler(
            walls="mean pressure of each face by itself",
            patterns=1,
            coupled=False,
            condition=row.condition,
            rate_relative_l2=None,
            settled_rate_error_deg_s=row.settled_rate_error_deg_s,
        )
        for row in rows
    )
    return table(
        uncalibrated=rows,
        fitted=rows[:1],
        held_out=rows[1:],
        compliant=rows,
        modal=rows,
        simpler=simpler,
    )


def test_what_holds_on_one_condition_is_not_promised_of_another():
    """Control: without the agreement study the errors of phi15 are taken, and that is said."""
    found = choose(COST, "phi60", agreement(13.0, 9.0), 0.03)
    assert found.bound_deg_s == 0.02
    assert found.why.endswith("errors on phi60 from tipoff compare")
    assert found.plain()["trusted_deg_s"] == 0.02 and found.plain()["model"] == found.point.model
    with pytest.raises(StudyError, match="(?s)no model fits.*errors on h8 from tipoff compare"):
        choose(COST, "h8", agreement(13.0, 9.0), 0.03)
    # a model without an error there never counts
    nearest = choose(COST, "h8", agreement(13.0, 9.0), budget=0.01)
    assert (nearest.point.model, nearest.bound_deg_s) == ("compliant", 13.0)
    with pytest.raises(StudyError, match="no model fits"):
        choose(COST, "h8", agreement(0.01, None), 0.03)
    for unknown in (None, agreement(13.0, 9.0)):
        assert choose(COST, "nominal", unknown, 0.03).why.endswith("none are measured on nominal")


def test_errors_below_the_uncertainty_of_the_reference_recommend_no_model():
    """All errors are below it under chaos, so the fastest springs would be the best. Control: the same
    points with a reference that is known to the limit of agreement."""
    springs = point(model="springs", rung="uncalibrated", error_deg_s=0.05, wall_s=0.001)
    measured = replace(COST, points=(springs, *COST.points))
    chaotic = replace(measured, band_deg_s=11.6)
    (warning,) = [part for part in draw(chaotic) if isinstance(part, Notice)]
    assert "On phi15 the reference is uncertain by 12 deg/s" in warning.text
    assert recommended(chaotic) is None and recommended(measured) is springs
    assert not any(isinstance(part, Notice) for part in draw(measured))
    within = {"budget": 0.01}
    assert choose(measured, "phi15", None, **within).point.model == "compliant fine"
    found = choose(replace(chaotic, points=(springs, *COST.points[2:])), "phi15", None, **within)
    assert found.point.model == "compliant" and "no error ranks the models" in found.why
    # the reference of another condition has its own uncertainty
    there = choose(measured, "h8", agreement(0.01, 9.0), **within)
    assert there.point.model == "compliant" and "no error ranks the models" in there.why
    known = choose(measured, "h8", agreement(0.01, 0.02), **within)
    assert known.point.model == "compliant fine" and "the most accurate" in known.why


def test_other_modes_are_chosen_only_where_they_were_measured():
    fewer = point(model="fewer", rung="modal", modes=1, error_deg_s=0.03, wall_s=0.0001)
    more = replace(COST, points=(*COST.points, fewer))
    assert choose(more, "phi15", agreement(13.0, 9.0), 0.05).point.model == "fewer"
    # where no model is known any better
    assert choose(more, "nominal", agreement(13.0, 9.0), 0.05).point.model == "fewer"
    assert choose(more, "phi60", agreement(13.0, 9.0), 0.05).point.model == "compliant"


def test_what_is_not_known_elsewhere_is_never_chosen():
    """A mesh coarser than any of the agreement study, and everything where a refinement did not
    settle. Control: a mesh it has."""
    coarse = point(model="8 mm", rung="highfi", setting=8e-3, error_deg_s=0.03, wall_s=3.0)
    finer = (item for item in COST.points if item.rung == "highfi")
    meshes = replace(COST, points=(coarse, *finer))
    assert choose(meshes, "phi15", None, 0.05).point.model == "8 mm"
    for limit in ({"accuracy": 9.5}, {"budget": 60.0}):
        assert choose(meshes, "h8", agreement(13.0, 9.0), **limit).point.model == "4 mm"
    with pytest.raises(StudyError, match="error unknown"):
        choose(COST, "h8", agreement(13.0, None), budget=60.0)


def test_every_model_has_a_bound_elsewhere():
    found = elsewhere(agreement(13.0, 9.0), "h8")
    assert found == {
        "uncalibrated": 13.0,
        "calibrated": 13.0,
        "compliant": 13.0,
        "modal": 13.0,
        "along": 13.0,
        "highfi": 9.0,
        "coarsest_m": 4e-3,
    }


def test_nothing_is_chosen_without_measured_cost(tmp_path):
    study = Study(scenes.load("tiny"), tmp_path / "tiny", Settings())
    with pytest.raises(StudyError, match="tipoff cost --scene tiny"):
        single.chosen(study, "phi15", 0.1, None)
    own = Study(scenes.load("tiny").replace({"name": "mine"}), tmp_path / "mine", Settings())
    with pytest.raises(StudyError, match="tipoff cost --scene FILE first"):
        single.chosen(own, "phi15", 0.1, None)


@pytest.mark.parametrize("degree", [2, None])
def test_a_chosen_point_runs_with_its_patterns(tmp_path, monkeypatch, degree):
    """And a run that the agreement table lacks says so. Control: a point that has the default."""
    study = Study(scenes.load("tiny"), tmp_path / "tiny", Settings(element_size=16e-3))
    found = point(
        model="patterns", rung="modal", setting=1e-6, error_deg_s=0.01, modes=0, degree=degree
    )
    made = []
    stored = SimpleNamespace(result=cost([found], 0.02))
    monkeypatch.setattr(cost_stage, "stored", lambda _: stored)
    candidate = Candidate("modal", "compliant", compliance={"phi15": None})
    monkeypatch.setattr(cost_stage, "surrogates", lambda *_: [candidate])
    monkeypatch.setattr(single, "result_of", lambda *given: made.append(given) or {})
    single.chosen(study, "phi15", 0.1, None)
    [(_, condition, request, _, agreement)] = made
    assert condition == "phi15" and request.numerics.modes == 0
    if degree is None:
        assert request.compliance is None and agreement is None
    else:
        assert request.compliance.degree == degree
        assert agreement.startswith("not in the agreement table; error 0.01 deg/s on ")


@pytest.mark.parametrize(
    "option", [["--model", "compliant"], ["--modes", "2"], ["--calibration", "a.toml"]]
)
def test_a_model_is_not_both_given_and_chosen(tmp_path, option):
    result = CliRunner().invoke(
        app, ["run", "--scene", "tiny", "--out", str(tmp_path), "--budget", "2 s", *option]
    )
    assert (
        result.exit_code == 2 and option[0] in result.stderr and "choose the model" in result.stderr
    )


@pytest.mark.parametrize(
    "options, words",
    [
        (["--accuracy", "0.1"], "deg/s"),
        (["--accuracy", "0.1 m"], "deg/s"),
        (["--budget", "2 mm"], "a quantity"),
        (["--budget", "-1 s"], "zero or more"),
    ],
)
def test_bad_limits_are_refused(tmp_path, options, words):
    result = CliRunner().invoke(app, ["run", "--scene", "tiny", "--out", str(tmp_path), *options])
    assert result.exit_code == 2 and options[0] in result.stderr and words in result.stderr


def test_refusal_of_both_limits_names_the_fastest_of_the_most_exact():
    with pytest.raises(
        StudyError, match="(?s)most accurate: compliant fine, - .*fastest: rigid, - "
    ):
        choose(COST, "phi15", None, accuracy=0.001, budget=0.001)


def test_a_model_without_an_error_is_no_reference():
    """One that exits but does not settle has no error, and does not get that of the finest mesh. Without
    the uncertainty of that mesh no bound is known at all. Control: the finest mesh itself is chosen."""
    meshes = [item for item in COST.points if item.rung == "highfi"]
    restless = replace(meshes[-1], model="restless", reference=False, wall_s=1e-4)
    asked = replace(COST, points=(*meshes, restless))
    assert choose(asked, "phi15", None, budget=60.0).point.model == "2 mm"
    with pytest.raises(StudyError, match="error unknown"):
        choose(replace(asked, band_deg_s=None), "phi15", None, accuracy=1.0)
    assert not any(item.pareto for item in cost_stage.marked(asked.points, None))
