"""Lengths in files of IGES: unit and scale of the model."""

import numpy as np
import pytest

from tests.meshes.test_solid import NONE, in_iges
from tipoff.meshes import solid

pytestmark = pytest.mark.gmsh


@pytest.mark.parametrize("unit, metres", [("1,2HIN", 0.0254), ("2,2HMM", 1e-3), ("6,1HM ", 1.0)])
def test_lengths_of_iges_are_in_the_unit_of_the_file(tmp_path, unit, metres):
    file = in_iges(tmp_path / "a.igs", lambda occ: occ.addBox(0, 0, 0, 4, 2, 1))
    file.write_text(file.read_text().replace("2,2HMM", unit))
    made = solid.build(file, metres, NONE)
    assert np.ptp(made.points, axis=0) == pytest.approx(metres * np.array([4.0, 2.0, 1.0]))
    assert len(made.cells) == 8


def test_a_model_of_iges_at_a_scale_is_refused(tmp_path):
    """gmsh reads its lengths as they stand, so that the part would have half or twice its size.
    Control: scale 1, also left out, after a text of separators."""
    file = in_iges(tmp_path / "a.igs", lambda occ: occ.addBox(0, 0, 0, 4, 2, 1))
    text = file.read_text().replace("Filename.iges", "Fi,1,;,na.iges")
    text = text.replace(",13HFi", ",14HFi").replace(".iges, ", ".iges,")
    assert text.count(",1.,2,2HMM") == 1
    for scale in (".5", "2.", "x."):
        file.write_text(text.replace(",1.,2,2HMM", f",{scale},2,2HMM"))
        with pytest.raises(ValueError, match=f"has the scale {scale}, where 1 is expected"):
            solid.build(file, 1e-3, NONE)
    # Control:
    for same in ("1 ", "  "):
        file.write_text(text.replace(",1.,2,2HMM", f",{same},2,2HMM"))
        assert len(solid.build(file, 1e-3, NONE).cells) == 8
