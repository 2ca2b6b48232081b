"""What the terminal shows of a calibration: tables with units, and the files."""

from dataclasses import replace

import numpy as np
from pydantic_core import to_jsonable_python

from tipoff.scenes import Calibration
from tipoff.studies.calibration import page, stage
from tipoff.studies.calibration.compliance import Compliance, UnderPad
from tipoff.studies.render import document

FOUND = Calibration(
    constants={"contact.stiffness": 7e7, "friction.static": 0.25},
    parameters=["force at 0.02 mm", "mu"],
    values=[6.26, 0.25],
    units=["N", "1"],
    lower=[1.0, 0.0],
    upper=[9.0, 1.0],
    justification=["", ""],
    information=np.eye(2),
    weak_directions=["mu with the force"],
    residuals={"phi15": {"rate_relative_l2": 0.0123}, "phi60": {}},
    conditions=["phi15", "phi60"],
    objective=0.5,
    intervals=[[6.0, 6.5], [float("-inf"), float("inf")]],
)
FIT = stage.fit_of(FOUND, "calibration.toml")
COMPLIANCE = Compliance(
    file="compliance-1.npz",
    stations=53,
    element_size_m=8e-3,
    under_a_pad=UnderPad(
        pad=0,
        place_m=[0.0, 0.1],
        mounts_m=[],
        direct_m_per_n={"-y": [1e-9, 4.5e-8]},
        cross_m_per_n={},
    ),
)


def shown(found, tmp_path):
    return document.terminal(page.terminal(found, tmp_path))


def test_model_error_is_a_column_where_there_is_one(tmp_path):
    assert "with model error" not in shown(FIT, tmp_path)
    wider = replace(FIT, with_model_error=[(5.0, 7.0), (0.1, 0.4)])
    assert "with model error" in shown(wider, tmp_path) and "5 to 7" in shown(wider, tmp_path)


def test_the_compliance_stands_before_the_springs(tmp_path):
    both = {"compliance": COMPLIANCE, "springs": FIT}
    text = document.terminal(page.of_models(to_jsonable_python(both), tmp_path))
    assert text.index("(nm/N)") < text.index("force at")
    assert f"  {tmp_path / 'compliance-1.npz'}" in text.splitlines() and " 45" in text
    without = to_jsonable_python({"compliance": Compliance()})
    assert document.terminal(page.of_models(without, tmp_path)) == "no contact: no compliance"
