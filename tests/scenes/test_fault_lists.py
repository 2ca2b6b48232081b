"""A message lists three faults of a kind and counts the others."""

import pytest

from tests.scenes.support import refused, small, write
from tipoff.scenes import csv_file
from tipoff.scenes.faults import Fault, SceneError


def test_a_bad_column_is_a_short_message(tmp_path):
    rows = "".join(f"{line},{line} N\n" for line in range(20_000))
    path = write(tmp_path, "curve.csv", "time_s,force_N\n" + rows)
    (fault,) = refused(small(thrust={"kind": "measured", "file": str(path)}))
    assert len(str(fault)) < 1000 and "'2 N' in line 4" in str(fault)
    assert "19994 more" in str(fault)
    _, faults = csv_file.quantities(path, {"time_s": "dimensionless", "force_N": "dimensionless"})
    assert len(faults) == 4 and len(str(SceneError(faults))) < 1000


def test_a_long_cell_is_cut(tmp_path):
    path = write(tmp_path, "a.csv", f"a,b\n1,2\n{'x' * 100_000},1\n")
    _, faults = csv_file.quantities(path, {"a": "dimensionless"})
    assert len(str(SceneError(faults))) < 300


@pytest.mark.parametrize("count, lines", [(3, 4), (4, 5), (20_000, 5)])
def test_faults_that_differ_in_numbers_are_one_kind(count, lines):
    faults = [
        Fault("cases.csv", f"line {place}, payload.mass", f"{place} m", f"kg, at most {place}")
        for place in range(count)
    ]
    error = SceneError(faults)
    assert len(str(error).splitlines()) == lines and len(error.faults) == count
    assert f"{count - 3:,} more" in str(error) or count == 3


def test_faults_of_other_kinds_are_all_listed():
    """Control."""
    faults = [Fault("a.toml", f"payload.{chr(97 + k)}", "1 m", "kg") for k in range(20)]
    assert len(str(SceneError(faults)).splitlines()) == 21
