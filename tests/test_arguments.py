"""What Python callers pass: unusual values are taken, wrong ones are a SceneError that names the
argument."""

from pathlib import Path

import numpy as np
import pint
import pytest

import tipoff
from tipoff import highfi, lowfi, units
from tipoff.scenes import arguments

TINY = tipoff.load("tiny")
OTHER = pint.UnitRegistry()
FE = "finite-elements"


def ensemble(**options):
    return tipoff.ensemble(TINY, [{"payload.mass": 9.0}], "springs", **options)


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
        lambda: tipoff.run(TINY, "springs", element_size=4e-3, safety=0.5, mode=1),
        ["3 faults", "element_size", "safety", "another model", "did you mean modes"],
    ),
    "modes of elements": (lambda: tipoff.run(TINY, FE, modes=3), ["modes", "another model"]),
    "half a cell": (lambda: tipoff.run(TINY, FE, cells=2.5), ["cells", "whole number"]),
    "text": (
        lambda: tipoff.run(TINY, "springs", relative_tolerance="fine"),
        ["relative_tolerance", "a number"],
    ),
    "no case": (lambda: tipoff.ensemble(TINY, [], "springs"), ["cases", "no case"]),
    "cases by number": (lambda: tipoff.ensemble(TINY, 8, "springs"), ["cases", "given an int"]),
    "a case of text": (lambda: tipoff.ensemble(TINY, [{}, "x"], "springs"), ["as case 1"]),
    "unequal columns": (
        lambda: tipoff.ensemble(TINY, {"payload.mass": [1.0, 2.0], "friction.static": [0.1]}),
        ["2 of payload.mass", "one length"],
    ),
    "a column that is a number": (
        lambda: tipoff.ensemble(TINY, {"payload.mass": 9.0}),
        ["cases.payload.mass", "a list"],
    ),
    "a scene that is a number": (lambda: tipoff.load(3.0), ["scene", "a float", "tiny"]),
    "a mapping that is none": (lambda: tipoff.parse([1]), ["table", "a list", "mapping"]),
    "overrides that are text": (lambda: TINY.replace("payload.mass"), ["table", "a str"]),
    "a key that is a number": (lambda: TINY.replace({3: 1.0}), ["key", "3", "as text"]),
    "a condition that is a list": (lambda: TINY.condition(["phi15"]), ["conditions", "phi15"]),
    "no model": (lambda: tipoff.run(TINY, None), ["model", "None", "springs"]),
    "an array of models": (lambda: tipoff.run(TINY, np.array(["springs"])), ["model", "one of"]),
    "other objects": (
        lambda: tipoff.run(TINY, "springs", compliance={}, calibration="c.toml", progress=True),
        ["3 faults", "compliance", "a dict", "tipoff.compliance", "c.toml", "progress"],
    ),
    "no thread": (lambda: ensemble(workers=0), ["workers", "0", "1 to"]),
    "half a thread": (lambda: ensemble(workers=2.5), ["workers", "2.5"]),
    "a store that is a number": (lambda: ensemble(store=3), ["store", "3", "path"]),
    "no name of a store": (lambda: ensemble(store=""), ["store", "path"]),
    "sometimes": (lambda: ensemble(sensitivity="yes"), ["sensitivity", "True or False"]),
    "no such key": (
        lambda: tipoff.ensemble(TINY, [{"payload.mas": 9.0}, {}], "springs"),
        ["cases.payload.mas", "no such key", "payload.mass"],
    ),
    "a number as key": (lambda: tipoff.ensemble(TINY, {1: [9.0]}, "springs"), ["cases", "as text"]),
    "steps without end": (
        lambda: tipoff.run(TINY, "springs", maximum_steps=10**400),
        ["maximum_steps", "above zero"],
    ),
    "no floor": (lambda: tipoff.run(TINY, "springs", speed_floor=None), ["speed_floor", "None"]),
    "modes as an array": (
        lambda: tipoff.run(TINY, "compliant", compliance=None, modes=np.array([1, 2])),
        ["modes", "0 to 20"],
    ),
    "references that are none": (lambda: tipoff.calibrate(TINY, "phi15"), ["references", "a str"]),
    "a reference that is a path": (
        lambda: tipoff.calibrate(TINY, {"phi15": "run.csv"}),
        ["references.phi15", "a str", "Curves"],
    ),
    "one name of a parameter": (
        lambda: tipoff.calibrate(TINY, {}, fit="friction.dynamic"),
        ["fit", "friction.dynamic", "list of names"],
    ),
    "a seed of text": (lambda: tipoff.calibrate(TINY, {}, seed="one"), ["seed", "whole"]),
    "steps of everything": (
        lambda: highfi.Numerics(element_size="4 mm", cells=2.5, step_everything=1),
        ["element_size", "cells", "step_everything"],
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


@pytest.mark.parametrize("given", ["rate", 3.0, []], ids=repr)
def test_other_axes_are_a_type_error(given):
    with pytest.raises(TypeError, match="axes: given a .*expected axes of matplotlib"):
        TINY.plot("thrust", given)


@pytest.mark.parametrize("load", [tipoff.RailCompliance.load, tipoff.Trajectory.load])
def test_a_number_is_no_path(load, tmp_path):
    """Python opens a number as a file that is open already, and closes it."""
    file = (tmp_path / "open").open("w")
    with pytest.raises((TypeError, ValueError), match="PathLike"):
        load(file.fileno())
    file.write("still open")
    file.close()


def test_scalars_of_numpy_are_numerics():
    found = highfi.Numerics(element_size=np.float64(8e-3), cells=np.int64(4), step=np.array(1e-8))
    assert found == highfi.Numerics(element_size=8e-3, cells=4, step=1e-8)
    assert lowfi.Numerics(modes=np.int32(3), maximum_steps=np.int64(9)).modes == 3


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
    tipoff.run(given, "springs", sensitivity=False)
    assert asked[0].hash == TINY.hash
