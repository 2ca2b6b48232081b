"""What ``import tipoff`` offers: which solver answers, and options that are refused before any work."""

import re
from copy import deepcopy
from dataclasses import fields, replace
from inspect import signature
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import typer

import tipoff
from tests.in_memory import memory
from tipoff import highfi, lowfi
from tipoff.calibration import rail_compliance
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import uncertainty
from tipoff.studies import cli
from tipoff.studies.ensemble.options import EnsembleOptions
from tipoff.workspace import disturbed

ROOT = Path(__file__).resolve().parent.parent

SCENE = tipoff.load("tiny")
CALIBRATION = tipoff.Calibration(
    {"contact.stiffness": 2.2e9}, [], [], [], [], [], [], np.zeros((0, 0)), [], {}, [], 0.0
)
FOUND = SimpleNamespace(
    flexibility=1.0,
    degree=2,
    nodes=None,  # not a long rail
    accuracy=lambda: "",
    stated=lambda: None,
    finding=lambda joints: FOUND,
)


@pytest.fixture
def solvers(monkeypatch, tmp_path):
    """What the solvers were asked for, in place of their runs."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # nothing is compiled
    asked = []
    unsettled = SimpleNamespace(outcome=SimpleNamespace(rate=None), numerics={})
    monkeypatch.setattr(highfi, "run", lambda *given: asked.append(("highfi", *given)))
    monkeypatch.setattr(
        lowfi, "run", lambda *given, **more: asked.append((*given, more)) or unsettled
    )
    monkeypatch.setattr(lowfi, "run_many", lambda *given, **more: asked.append((*given, more)))
    return asked


@pytest.fixture
def found(monkeypatch, tmp_path):
    """What was done to find compliances, with element done (m), in place of their statics."""
    done = []

    def compute(scene, element_size, degree, waits):
        done.append(element_size)
        return FOUND

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(rail_compliance, "computed", compute)
    monkeypatch.setattr(rail_compliance, "KEPT", memory())
    return done


def test_every_name_is_there():
    assert all(hasattr(tipoff, name) for name in tipoff.__all__)
    assert dir(tipoff) == tipoff.__all__
    with pytest.raises(AttributeError, match="no attribute 'walls'"):
        _ = tipoff.walls


def test_finite_elements_take_their_own_numerics(solvers):
    tipoff.run(SCENE, "finite-elements", element_size=8e-3)
    assert solvers == [("highfi", SCENE, highfi.Numerics(element_size=8e-3), None)]


def test_compliant_contact_finds_its_compliance_once(solvers, found, capsys):
    for _ in range(2):
        tipoff.run(SCENE, modes=2)
    assert found == [8e-3]  # tiny states 8 mm
    assert capsys.readouterr().err.count("rail compliance, once") == 1
    (_, model, first), (_, _, again) = solvers
    assert model == "compliant" and first["numerics"] == lowfi.Numerics(modes=2)
    assert again["compliance"] is FOUND


def test_elements_do_not_depend_on_the_name_or_on_what_is_stored(solvers, found):
    """A scene that is named tiny but states no element size has those of the reference, also where a
    compliance of other elements is stored."""
    named = tipoff.load("reference").replace({"name": "tiny"})
    tipoff.compliance(named, 4e-3)
    tipoff.run(named)
    tipoff.run(SCENE.replace({"name": "mine"}))
    assert found == [4e-3, 2e-3, 8e-3]
    tipoff.run(named, "finite-elements")
    tipoff.run(SCENE, "finite-elements")
    assert [asked[2].element_size for asked in solvers[-2:]] == [2e-3, 8e-3]


def test_springs_need_no_compliance_but_on_warm_rails(solvers, found):
    tipoff.run(SCENE, "springs", calibration=CALIBRATION)
    assert solvers[0][2]["compliance"] is None and solvers[0][2]["calibration"] is CALIBRATION
    assert found == []


def test_a_first_use_is_announced_once(solvers, capsys):
    """Single runs and ensembles have the same."""
    words, said = "compiling the kernels of model springs", []
    for run in (
        lambda: tipoff.run(SCENE, "springs"),
        lambda: tipoff.ensemble(SCENE, [{}], "springs"),
    ):
        for _ in range(2):
            run()
            said.append(capsys.readouterr().err.count(words))
    assert len(solvers) == 4 and said == [1, 0, 0, 0]


def test_an_ensemble_draws_as_many_cases_as_asked_for(solvers):
    tipoff.ensemble(SCENE, "paper", "springs", count=7, seed=3, relative_tolerance=1e-3)
    (_, cases, model, more) = solvers[0]
    assert (cases.cases, cases.seed, model) == (7, 3, "springs")
    assert more["numerics"] == lowfi.Numerics(relative_tolerance=1e-3)


@pytest.mark.parametrize(
    ("model", "given"),
    [
        ("finite-elements", {"compliance": CALIBRATION, "calibration": CALIBRATION}),
        ("compliant", {"calibration": CALIBRATION}),
        ("walls", {}),
    ],
)
def test_options_of_another_model_are_refused_before_any_work(solvers, found, model, given):
    with pytest.raises(tipoff.SceneError) as caught:
        tipoff.run(SCENE, model, **given)
    assert [fault.key for fault in caught.value.faults] == (list(given) or ["model"])
    assert solvers == [] and found == []


def test_an_ensemble_is_that_of_the_command(solvers, found):
    """By default it has the errors that the scene states, and the tolerance of the command. Control: the errors
    of the paper, which the scene does not state, and numerics that the caller gives."""
    scene = tipoff.load("cubesat_3u")
    assert scene.studies.errors not in (None, "paper")
    tipoff.ensemble(scene)
    (_, cases, model, more) = solvers[-1]
    assert cases == uncertainty.load(scene.studies.errors, scene)
    assert cases.vary.keys() != uncertainty.load("paper", scene).vary.keys()
    numerics = lowfi.Numerics.of_many(EnsembleOptions().tolerance)
    assert (model, more["numerics"]) == ("compliant", numerics)
    assert numerics != lowfi.Numerics(relative_tolerance=EnsembleOptions().tolerance)
    tipoff.ensemble(scene, "paper", cells=12, sampling="sobol")
    (_, cases, _, more) = solvers[-1]
    assert cases == uncertainty.load("paper", scene, sampling="sobol")
    assert more["numerics"] == replace(numerics, cells=12)
    tipoff.ensemble(scene, relative_tolerance=1e-8)
    assert solvers[-1][3]["numerics"] == lowfi.Numerics(relative_tolerance=1e-8)


def test_elements_of_the_compliance_may_be_given(solvers, found):
    tipoff.run(SCENE, element_size="4 mm")
    tipoff.ensemble(SCENE, [{}], element_size=5e-3)
    assert found == [4e-3, 5e-3]
    for given, words in (
        ({"compliance": tipoff.RailCompliance.__new__(tipoff.RailCompliance)}, "has its elements"),
        ({"model": "springs"}, "another model"),
    ):
        with pytest.raises(tipoff.SceneError, match=words):
            tipoff.run(SCENE, **given, element_size="4 mm")
    free = SCENE.replace({"contact": None, "friction": None})
    with pytest.raises(tipoff.SceneError, match="without contact"):
        tipoff.run(free, element_size="4 mm")


@pytest.mark.parametrize("condition, warned", [("phi60", False), ("h8", True)])
def test_a_sensitive_run_warns(condition, warned):
    """As the command does. Control: a run that is not sensitive, and one without its three further runs."""
    scene = tipoff.load("reference").condition(condition)
    run = tipoff.run(scene, "springs")
    change = run.checks["rate_change_by_clearance_deg_s"]
    assert (change > 0.1) is warned
    words = f"1 µm of clearance changes a rate by {change:.2g} deg/s"
    assert (words in run.message) is (words in run.summary()) is warned
    assert f"{change:.2g} deg/s by 1 µm of clearance" in run.summary()
    alone = tipoff.run(scene, "springs", sensitivity=False)
    assert alone.message == "" and "sensitivity" not in alone.summary()
    assert alone.outcome == run.outcome


def test_a_run_is_disturbed_when_its_checks_or_its_message_are_used(monkeypatch, tmp_path):
    """Once: by name, in a copy, and in a file. Control: a loop that reads the outcome makes no further run."""
    calls, execute = [], disturbed.execute
    monkeypatch.setattr(disturbed, "execute", lambda run: calls.append(run) or execute(run))
    scene = tipoff.load("reference").condition("h8")
    run, other, third, fourth = (tipoff.run(scene, "springs") for _ in range(4))
    assert run.outcome.rate and run.status == "exited" and repr(run) and run.rate.any()
    assert not calls
    with pytest.raises(AttributeError, match="no attribute 'check'"):
        getattr(run, "check")  # noqa: B009
    assert "sensitive" in run.message and run.checks["rate_change_by_clearance_deg_s"] > 0.1
    assert len(calls) == 3
    copied = deepcopy(other)
    assert set(vars(copied)) == {item.name for item in fields(copied)}
    assert copied.checks == replace(third, status="jammed").checks == run.checks
    assert len(calls) == 9
    fourth.save(tmp_path / "run.nc")
    loaded = tipoff.Trajectory.load(tmp_path / "run.nc")
    assert len(calls) == 12
    assert (loaded.message, loaded.checks) == (run.message, run.checks)


@pytest.mark.parametrize("stored", [False, True])
def test_a_data_set_has_the_inputs_of_its_cases(tmp_path, stored):
    """In SI under the dotted keys; a case without a key has the value of the scene."""
    store = {"store": tmp_path / "cases"} if stored else {}
    rows = [{"payload.mass": "10 kg"}, {"friction.dynamic": 0.1, "contact.law": "linear"}]
    cases = tipoff.ensemble(SCENE, rows, "springs", **store)
    assert cases["payload.mass"].values.tolist() == [10.0, SCENE.payload.mass]
    assert cases["payload.mass"].dims == ("case",) and cases["payload.mass"].units == "kg"
    assert cases["friction.dynamic"].values.tolist() == [SCENE.friction.dynamic, 0.1]
    assert cases["contact.law"].values.tolist() == [SCENE.contact.law, "linear"]
    drawn = tipoff.ensemble(SCENE, "paper", "springs", count=3, seed=5)
    expected = Drawn(uncertainty.load("paper", SCENE, cases=3, seed=5))
    for key in expected.keys:
        assert drawn[key].values.tolist() == [row[key] for row in expected.rows(0, 3)]
    assert "mass_offset.eccentricity 0 to 0.258 mm" in drawn.errors and "errors" not in cases.attrs


def test_scenes_are_keys_of_dictionaries():
    again = tipoff.load("tiny")
    assert again == SCENE and hash(again) == hash(SCENE)
    assert len({SCENE, again, SCENE.condition("phi15"), SCENE.replace({"payload.mass": 9.0})}) == 3


def test_every_option_of_command_and_function_is_in_the_table():
    """Control: the table has no option that neither has."""
    page = (ROOT / "docs/reference/python.md").read_text(encoding="utf-8")
    rows = page.split("| meaning |")[1].split("\n\n")[0]
    named = set(re.findall(r"`(-{0,2}[a-z][a-z_-]*)`", rows))
    commands = typer.main.get_command(cli.app).commands
    options = {item.opts[0] for name in ("run", "ensemble") for item in commands[name].params} - {
        "--help"
    }
    arguments = {
        name
        for function in (tipoff.run, tipoff.ensemble)
        for name, item in signature(function).parameters.items()
        if item.kind is not item.VAR_KEYWORD
    }
    arguments |= {
        item.name for numerics in (lowfi.Numerics, highfi.Numerics) for item in fields(numerics)
    }
    assert options | arguments <= named
    assert {name for name in named if name.startswith("--")} <= options


def test_listed_cases_are_not_drawn(solvers):
    with pytest.raises(tipoff.SceneError, match="count, seed, sampling"):
        tipoff.ensemble(SCENE, [{}], "springs", count=7)
    with pytest.raises(tipoff.SceneError, match="one of compliant, springs"):
        tipoff.ensemble(SCENE, [{}], "finite-elements")
    assert solvers == []


@pytest.mark.parametrize("model", ["compliant", "springs", "finite-elements"])
def test_every_model_refuses_pads_on_the_fillet(solvers, found, model):
    scene = SCENE.replace({"rail.fillet": "4.5 mm"})
    with pytest.raises(tipoff.SceneError, match="pads beside the fillet"):
        tipoff.run(scene, model)
    if model != "finite-elements":
        with pytest.raises(tipoff.SceneError, match="pads beside the fillet"):
            tipoff.ensemble(scene, [{}], model)
    assert not solvers and not found
