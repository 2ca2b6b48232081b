"""Tables of runs have the range of a sensitive one in place of its values."""

import tipoff
from tipoff.studies.runs import page
from tipoff.studies.runs import stage as runs
from tipoff.studies.single import single
from tipoff.uncertain import range_of
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

TINY = tipoff.load("tiny")


def test_every_table_of_runs_has_the_range_of_a_sensitive_one(tmp_path):
    """Of all conditions and of some. Control: a tame condition beside it has its values."""
    study = Study(TINY, tmp_path, defaults("tiny"), only=("h7", "phi15"))
    every = {row.condition: row for row in runs.run(study, "lowfi").result.conditions}
    found = every["h7"].range
    assert found is not None and every["phi15"].range is None
    some = single.rows(single.several(["h7", "phi15"], lambda name: single.run(study, name)))
    assert [row.range for row in some] == [found, None]
    for rows in (some, tuple(every.values())):
        (table,) = page.draw(rows)
        cells = {row[0]: dict(zip(table.heads, row)) for row in table.rows}
        spans = (*zip(found.low_deg_s, found.high_deg_s), (found.low_m_s[0], found.high_m_s[0]))
        names = (*(f"rate {axis} (deg/s)" for axis in "xyz"), "v_x (m/s)")
        for name, ends in zip(names, spans):
            least = 1e-4 if name.startswith("v") else 1e-3
            assert cells["h7"][name] == range_of(*ends, least=least)
            assert isinstance(cells["phi15"][name], float)
        assert cells["h7"]["rate at exit x, y, z (deg/s)"] is None and page.RANGES in table.notes
