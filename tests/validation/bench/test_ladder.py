"""The ladder of compliant contact: one condition on a coarse mesh."""

import pytest

from tipoff.files import read_json
from validation.bench import ladder
from validation.bench.command import ladder as command


@pytest.mark.slow
def test_rungs_come_nearer_to_the_finite_elements(tmp_path, capsys):
    """Control: the first rung is farther away."""
    command(out=tmp_path, scene="tiny", condition=["phi15"], element_size=8.0, json_=False)
    rows = read_json(tmp_path / "bench" / "ladder.json")["rows"]
    asked = [(row["degree"], row["modes"].split(",")[0]) for row in rows]
    assert asked == [(degree, str(modes)) for degree, modes in ladder.RUNGS]
    chosen = [int(row["modes"].split(", ")[1]) for row in rows if "auto" in row["modes"]]
    assert len(chosen) == 2 and all(0 <= count <= 20 for count in chosen)
    assert all(row["wall_ms"] > 0.0 and row["reference_wall_s"] > 0.0 for row in rows)
    assert rows[-1]["rate_l2"] < 2e-3 < rows[0]["rate_l2"]
    shown = capsys.readouterr().out
    assert "phi15" in shown and "8 mm" in shown
