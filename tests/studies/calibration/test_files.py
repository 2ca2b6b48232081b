"""Calibration files given to the commands."""

import pytest

from tests.fuzz.cases import CALIBRATION
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes import SceneError
from tipoff.studies.calibration.files import constants


@pytest.mark.parametrize("scene, told", [("own", ""), ("other", "fitted on the scene own")])
def test_a_calibration_of_another_scene_is_announced(tmp_path, capsys, scene, told):
    file = tmp_path / "c.toml"
    file.write_text(CALIBRATION + '\n[provenance]\nscene = "own"\n')
    found = constants(file, SPRINGS, scene)
    assert found is not None and found.provenance["scene"] == "own"
    assert capsys.readouterr().err == (
        f"{file}: fitted on the scene own, and applied to other\n" if told else ""
    )


def test_constants_of_springs_are_refused_on_compliant_contact(tmp_path):
    file = tmp_path / "c.toml"
    file.write_text(CALIBRATION)
    with pytest.raises(SceneError, match="constants of springs"):
        constants(file, COMPLIANT, "own")
