"""What contact cells and patterns change in an ensemble: a few cases on a coarse mesh."""

import pytest

from tipoff.files import read_json
from validation.bench import cells
from validation.bench.command import cells as command


@pytest.mark.slow
def test_more_cells_come_nearer_to_many(tmp_path, capsys):
    """The last row has the numerics of a single run. Control: the first one, of an ensemble, is farther away."""
    command(out=tmp_path, scene="tiny", cases=24, element_size=16.0, json_=False)
    rows = read_json(tmp_path / "bench" / "cells.json")["rows"]
    assert [(row["cells"], row["degree"]) for row in rows] == [(10, 2), (13, 2), (16, 2), (16, 3)]
    assert 0.0 < rows[-1]["median"] < 0.5 * rows[0]["median"] < 0.05
    assert all(row["median"] <= row["nine_tenths"] for row in rows)
    assert f"against {cells.FINEST} cells" in capsys.readouterr().out
