"""How long a person waits: the table, the rails, and the command on one rail."""

import numpy as np
import pytest

from tipoff.files import read_json
from tipoff.studies.render import document
from validation.bench import waits
from validation.bench.command import waits as command

ROW = {"call": "run", "wall_ms": 2.5, "cpu_ms": 2.0, "repeats": 3, "file_mb": None}
FOUND = {"rows": [ROW], "hardware": {"cores": 2, "processor": "any"}}


def test_an_earlier_result_stands_beside():
    """Control: without one there is no such column; a call that it does not have stays empty."""
    earlier = FOUND | {"rows": [ROW | {"wall_ms": 38.0}]}
    assert "before" not in document.terminal([waits.table(FOUND)])
    assert "38" in document.terminal([waits.table(FOUND, earlier)])
    other = FOUND | {"rows": [ROW | {"call": "another", "wall_ms": 38.0}]}
    assert "38" not in document.terminal([waits.table(FOUND, other)])


@pytest.mark.parametrize("length", waits.LENGTHS)
def test_a_long_rail_is_held_along_its_length(length):
    rail = waits.long_rail(length).rail
    ends = [span.end for span in rail.mounts]
    assert rail.end - rail.start == pytest.approx(length) and 0.0 < rail.end - max(ends) < 0.1


@pytest.mark.parametrize("length", waits.SLOTS)
def test_a_long_slot_is_held_along_its_length(length):
    rail = waits.long_slot(length).rail
    starts = [span.start for span in rail.mounts]
    assert rail.end - rail.start == pytest.approx(length) and len(starts) >= 3
    assert starts[0] < 0.1 and 0.0 < length - starts[-1] < 0.4 and max(np.diff(starts)) < 0.85


@pytest.mark.slow
def test_each_call_is_timed(tmp_path, capsys):
    command(out=tmp_path, repeats=1, length=[0.22], against=None, json_=False)
    rows = read_json(tmp_path / "bench" / "waits.json")["rows"]
    assert all(row["wall_ms"] > 0.0 and row["cpu_ms"] > 0.0 for row in rows) and len(rows) == 12
    assert "compliance, 0.22 m" in capsys.readouterr().out
