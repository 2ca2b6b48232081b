"""What Python callers pass: unusual values are taken, wrong ones are a SceneError that names the
argument."""

from pathlib import Path

import numpy as np
import pint
import pytest

import tipoff
from tipoff import highfi, lowfi
from tipoff.scenes import arguments, units

TINY = tipoff.load("tiny")
OTHER = pint.UnitRegistry()
FE = "finite-elements"

# call, words of the message
WRONG = {
    "no scene": (lambda: tipoff.run(None), ["scene", "None", "tipoff.load"]),
    "a number as scene": (lambda: tipoff.ensemble(3.0), ["scene", "a float"]),
    "a misspelt name": (lambda: tipoff.run("tinny"), ["tinny", "did you mean tiny"]),
    "no scene for a compliance": (lambda: tipoff.compliance(None), ["scene", "None"]),
    "no scene for a fit": (lambda: tipoff.calibrate(None, {}), ["scene", "None"]),
    "metres": (lambda: tipoff.run(TINY, FE, element_size=4), ["element_size", "0.1 (m)"]),
    "metres of statics": (lambda: tipoff.compliance(TINY, 4), ["element_size", "5e-05 to 0.1"]),
    "negative": (lambda: tipoff.compliance(TINY, -1e-3), ["element_size", "-0.001"]),
    "NaN": (lambda: tipoff.run(TINY, FE, element_size=np.nan), ["element_size", "NaN"]),
    "true": (lambda: tipoff.run(TINY, FE, element_size=True), ["element_size", "True"]),
    "a mass": (lambda: tipoff.run(TINY, FE, element_size="4 kg"), ["element_size", "4 kg"]),
    "other models": (
        lambda: tipoff.run(TINY, "springs", element_size=4e-3, cells=3, mode=1),
        ["3 faults", "element_size", "cells", "another model", "did you mean modes"],
    ),
    "modes of elements": (lambda: tipoff.run(TINY, FE, modes=3), ["modes", "another model"]),
    "half a cell": (lambda: tipoff.run(TINY, FE, cells=2.5), ["cells", "whole number"]),
    "text": (
        lambda: tipoff.run(TINY, "springs", relative_tolerance="fine"),
        ["relative_tolerance", "a number"],
    ),
    "no case": (lambda: tipoff.ensemble(TINY, [], "springs"), ["cases", "no case"]),
    "no cases": (lambda: tipoff.ensemble(TINY, None, "springs"), ["cases", "None"]),
    "a case of text": (lambda: tipoff.ensemble(TINY, [{}, "x"], "springs"), ["as case 1"]),
    "unequal columns": (
        lambda: tipoff.ensemble(TINY, {"payload.mass": [1.0, 2.0], "friction.static": [0.1]}),
        ["2 of payload.mass", "one length"],
    ),
    "a column that is a number": (
        lambda: tipoff.ensemble(TINY, {"payload.mass": 9.0}),
        ["cases.payload.mass", "a list"],
    ),
    "compared with nothing": (lambda: tipoff.compare(None, TINY), ["reference", "None"]),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_arguments_are_faults_with_their_name(name):
    call, words = WRONG[name]
    with pytest.raises(ValueError) as caught:
        call()
    assert all(word in str(caught.value) for word in words), str(caught.value)
    assert "object has no attribute" not in str(caught.value)


MASSES = [10.0, 11.0]


def frame():
    return pytest.importorskip("pandas").DataFrame({"payload.mass": MASSES})


def dataset():
    import xarray

    return xarray.Dataset({"payload.mass": ("case", MASSES)})


TABLES = {
    "list": lambda: [{"payload.mass": mass} for mass in MASSES],
    "tuple": lambda: tuple({"payload.mass": mass} for mass in MASSES),
    "columns": lambda: {"payload.mass": MASSES},
    "arrays": lambda: {"payload.mass": np.array(MASSES)},
    "pandas": frame,
    "xarray": dataset,
    "structured": lambda: np.array([(mass,) for mass in MASSES], dtype=[("payload.mass", "f8")]),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_of_cases_are_rows(name):
    assert arguments.rows(TABLES[name]()) == [{"payload.mass": mass} for mass in MASSES]


@pytest.mark.parametrize(
    "given",
    [
        "12 kg",
        12,
        np.float32(12.0),
        np.int64(12),
        np.array(12.0),
        OTHER.Quantity(12.0, "kg"),
        OTHER.Quantity(12_000, "g"),
        units.registry().Quantity(np.array(12.0), "kg"),
    ],
    ids=repr,
)
def test_numbers_of_any_kind_are_taken(given):
    assert TINY.replace({"payload.mass": given}).payload.mass == pytest.approx(12.0, rel=1e-15)


@pytest.mark.parametrize("given", [True, np.bool_(True), np.array([12.0]), OTHER.Quantity(1, "m")])
def test_other_things_are_no_mass(given):
    with pytest.raises(tipoff.SceneError, match="payload.mass"):
        TINY.replace({"payload.mass": given})


@pytest.mark.parametrize("given", ["8 mm", 8e-3, np.float64(8e-3), OTHER.Quantity(8, "mm")])
def test_lengths_have_their_units(given, monkeypatch, tmp_path):
    asked = []
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # nothing is compiled
    monkeypatch.setattr(highfi, "run", lambda *given: asked.append(given[1]))
    tipoff.run(TINY, FE, element_size=given)
    assert asked[0].element_size == pytest.approx(8e-3, rel=1e-15)


@pytest.mark.parametrize("given", ["tiny", TINY, Path("own.toml")], ids=str)
def test_a_scene_may_be_a_name_or_a_path(given, monkeypatch, tmp_path):
    asked = []
    monkeypatch.chdir(tmp_path)
    Path("own.toml").write_text('extends = "tiny"\n')
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(lowfi, "run", lambda scene, *_, **__: asked.append(scene))
    tipoff.run(given, "springs")
    assert asked[0].hash == TINY.hash
