"""Calibration files: what is written is read back, to the bit."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tipoff import toml
from tipoff.scenes import Calibration, SceneError, load

CALIBRATION = Calibration(
    constants={"contact.stiffness": 0.1 + 0.2, "friction.static": 0.25},
    parameters=["log force at 0.02 mm", "mu"],
    values=[1 / 3, 1e-300],
    units=["1", "1"],
    lower=[-1e16, 0.0],
    upper=[float("inf"), 1.0],
    justification=['quoted "text"', "two\nlines, a \\ and a µ\x7f"],
    information=np.array([[1.0, 2e-17], [2e-17, 3.0]]),
    weak_directions=[],
    residuals={"phi15": {"l2": 0.01, "settled": -0.0}, 'a "b".c': {}},
    conditions=["phi15"],
    objective=5e-324,
    provenance={"code": "0"},
    intervals=[[0.25, 0.5], [float("-inf"), float("inf")]],
)


def as_lists(calibration):
    return {
        name: np.asarray(value).tolist() if name == "information" else value
        for name, value in vars(calibration).items()
    }


def test_round_trip(tmp_path):
    CALIBRATION.save(tmp_path / "c.toml")
    assert as_lists(Calibration.load(tmp_path / "c.toml")) == as_lists(CALIBRATION)


@given(
    st.one_of(
        st.text(alphabet=st.characters(exclude_categories=["Cs"])),
        st.floats(allow_nan=False),
        st.integers(-(2**63), 2**63 - 1),
        st.booleans(),
        st.lists(st.dictionaries(st.text(st.sampled_from('ab ."')), st.integers(0, 9))),
        st.dictionaries(
            st.text(st.sampled_from('ab ."')),
            st.dictionaries(st.sampled_from("ab"), st.floats(-1, 1)),
        ),
    )
)
def test_any_value_survives_toml(value):
    assert tomllib.loads(toml.dumps({"x": value})) == {"x": value}


def test_numpy_scalars_are_written(tmp_path):
    replace(CALIBRATION, objective=np.float32(0.5), values=[np.int64(3), np.float64(0.1)]).save(
        tmp_path / "c.toml"
    )
    assert Calibration.load(tmp_path / "c.toml").values == [3, 0.1]


def test_no_nan_is_written(tmp_path):
    with pytest.raises(ValueError, match="NaN"):
        replace(CALIBRATION, objective=float("nan")).save(tmp_path / "c.toml")
    assert list(tmp_path.iterdir()) == []


def test_constants_are_applied():
    scene = load("tiny")
    assert CALIBRATION.apply(scene).friction.static == 0.25
    assert CALIBRATION.apply(scene).contact.stiffness == 0.1 + 0.2
    assert CALIBRATION.apply(scene.replace({"friction": None})).friction is None


def test_a_constant_no_scene_has_is_a_scene_error():
    with pytest.raises(SceneError, match="no such key"):
        replace(CALIBRATION, constants={"spring.stiffness": 1.0}).apply(load("tiny"))
