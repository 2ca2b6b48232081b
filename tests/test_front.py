"""What ``import tipoff`` offers: which solver answers, and options that are refused before any work."""

from types import SimpleNamespace

import numpy as np
import pytest

import tipoff
from tests.in_memory import memory
from tipoff import highfi, lowfi
from tipoff.calibration import rail_compliance

SCENE = tipoff.load("tiny")
CALIBRATION = tipoff.Calibration(
    {"contact.stiffness": 2.2e9}, [], [], [], [], [], [], np.zeros((0, 0)), [], {}, [], 0.0
)
FOUND = SimpleNamespace(
    flexibility=1.0, degree=2, accuracy=lambda: "", finding=lambda joints: FOUND
)


@pytest.fixture
def solvers(monkeypatch, tmp_path):
    """What the solvers were asked for, in place of their runs."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # nothing is compiled
    asked = []
    monkeypatch.setattr(highfi, "run", lambda *given: asked.append(("highfi", *given)))
    monkeypatch.setattr(lowfi, "run", lambda *given, **more: asked.append((*given, more)))
    monkeypatch.setattr(lowfi, "run_many", lambda *given, **more: asked.append((*given, more)))
    return asked


@pytest.fixture
def found(monkeypatch, tmp_path):
    """What was done to find compliances, with element done (m), in place of their statics."""
    done = []

    def compute(scene, element_size, degree):
        done.append(element_size)
        return FOUND

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(rail_compliance, "compliance", compute)
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
    """Kernels of single runs and of ensembles apart."""
    words = "compiling the kernels of model springs"
    for run in (
        lambda: tipoff.run(SCENE, "springs"),
        lambda: tipoff.ensemble(SCENE, [{}], "springs"),
    ):
        for times in (1, 0):
            run()
            assert capsys.readouterr().err.count(words) == times
    assert len(solvers) == 4


@pytest.mark.parametrize("chosen", [(), (2, 20)])
def test_kernels_of_chosen_modes_are_announced_before_they_are_used(
    monkeypatch, found, tmp_path, capsys, chosen
):
    """Control: a run that chooses none."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    said = []

    def run(scene, model, *, vibrates, **_):
        for modes in chosen:
            vibrates(modes)
            said.append(capsys.readouterr().err)

    monkeypatch.setattr(lowfi, "run", run)
    tipoff.run(SCENE)
    assert ["with modes of the rails" in text for text in said] == ([True, False] if chosen else [])


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


def test_listed_cases_are_not_drawn(solvers):
    with pytest.raises(tipoff.SceneError, match="count, seed"):
        tipoff.ensemble(SCENE, [{}], "springs", count=7)
    with pytest.raises(tipoff.SceneError, match="one of compliant, springs"):
        tipoff.ensemble(SCENE, [{}], "finite-elements")
    assert solvers == []
