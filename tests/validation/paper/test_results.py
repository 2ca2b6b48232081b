"""What stage ``paper`` makes of its searches: what the best set leaves its rail with beside the
rates, and paper.nc."""

import dataclasses
import os

import numpy as np
import pytest
import xarray

from tests.studies.synthetic import undrawn
from tests.validation.paper.searched import BASE, COUNT, SMALL, copied, page, shown, stub, studied
from tipoff import lowfi
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Case
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.outcome import Outcome
from tipoff.studies.populations import answers
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study
from validation import published
from validation.paper import exits, inputs, misfit, results, solutions, summary
from validation.paper import page as section
from validation.paper import stage as paper

# the paper's conditions by their names in the catalogue
PHI = ("phi0", "phi15", "phi35", "phi60", "phi90")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folder and result of a study of two starts whose searches take no time, three of four with
    admissible points."""
    folder = tmp_path_factory.mktemp("paper")
    return folder, studied(folder, stub(admissible=(3, 1)), dataclasses.replace(SMALL, starts=2))


@pytest.fixture
def quick(made, tmp_path, monkeypatch):
    """A copy of it: the study and its result."""
    undrawn(monkeypatch)
    monkeypatch.setattr(solutions, "run", stub(admissible=(3, 1)))
    return copied(made, tmp_path)


def _opened(study):
    with xarray.open_dataset(study.path("paper.nc"), engine="h5netcdf") as found:
        return found.load()


def test_exits_are_those_of_single_runs():
    """Rates are the bits that a search keeps of its end; the rest is what whole trajectories of the
    same scenes end with."""
    shares, launcher = (
        np.random.default_rng(5).uniform(0.2, 0.8, COUNT),
        misfit.Launcher(BASE, 1e-5),
    )
    left = exits.run(launcher, shares)
    assert np.degrees(left.rate).tolist() == launcher.rates(shares).tolist()
    scene, rows = launcher.scene(shares), exits.summary(left)["conditions"]
    for name, row in zip(PHI, rows, strict=True):
        alone = lowfi.run(
            scene.condition(name), "springs", numerics=Numerics(relative_tolerance=1e-5)
        ).outcome
        across = np.hypot(alone.velocity[1], alone.velocity[2])
        assert row["status"] == "exited"
        assert row["lateral_velocity_mm_s"] == pytest.approx(1e3 * across, rel=1e-6)
        assert row["direction_error_deg"] == pytest.approx(
            np.degrees(np.arctan2(across, alone.velocity[0])), rel=1e-6
        )
        assert [row[f"attitude_{axis}_deg"] for axis in "xyz"] == pytest.approx(
            np.degrees(alone.exit_attitude).tolist(), rel=1e-6
        )
    for item in answers.ALL:  # or conditions that stand in each other's place would not be noticed
        values = np.array([row[item.name] for row in rows])
        assert np.min(np.diff(np.sort(values))) > 1e-5 * np.abs(values).max()


def test_every_quantity_of_every_condition_is_shown(quick):
    found = quick[1]
    conditions = found["exit"]["conditions"]
    assert [row["condition"] for row in conditions] == list(published.angles())
    table = section.table_at_exit(found["exit"])
    assert "paper prints rates" in table.notes[0]
    for item, (label, *values) in zip(answers.ALL, table.rows, strict=True):
        assert label == f"{item.label} ({item.unit})" and label in page(found)
        assert values == [row[item.name] for row in conditions]


def test_a_condition_that_does_not_settle_has_no_values_and_shows_its_status(quick, monkeypatch):
    """Control: the other four keep theirs."""
    monkeypatch.setenv("COLUMNS", "500")  # no cell of a table is wrapped
    found, ended = (
        quick[1],
        Outcome(
            0.1, 0.1, [5.0, 0.003, 0.004], [0.0, 0.0, 0.1], 0.005, 0.001, *[[0.0, 0.0, 0.0]] * 6
        ),
    )
    cases = [Case("exited", "", ended, 10, 0.0)] * 5
    cases[2] = Case("time_limit", "", Outcome(), 10, 0.0)
    odd = found | {"exit": exits.summary(columns.of_cases(cases))}
    table = section.table_at_exit(odd["exit"])
    assert table.rows[4][1:] == (5.0, 5.0, None, 5.0, 5.0)
    assert table.heads[3] == "3 at 35 deg, time limit"
    for text in (page(odd), shown(odd)):
        assert text.count("time limit") == 1
    assert "time limit" not in page(found)


def test_data_hold_what_the_searches_ended_with(quick):
    study, found = quick
    data = _opened(study)
    assert (
        found["data"] == "paper.nc"
        and data.attrs["best_search"] == found["best"]
        and data.sizes["search"] == 4
    )
    for place, item in enumerate(found["searches"]):
        end = data.sel(search=place)
        assert (float(end.stress), int(end.seed)) == (item["stress"], item["seed"])
        assert end.rates_deg_s.values.tolist() == item["rates_deg_s"]
        assert end.changed_deg_s.values.tolist() == item["changed_deg_s"]
        for unknown in inputs.UNKNOWNS:
            assert float(end[f"end_{unknown.name}"]) == pytest.approx(
                unknown.factor * item["values"][unknown.name], rel=1e-14
            )
    # or searches in another order would not be noticed
    assert not np.array_equal(data.rates_deg_s[0], data.rates_deg_s[2])
    assert (
        np.column_stack(
            [data.front_largest_error_deg_s, data.front_largest_negligible_deg_s]
        ).tolist()
        == found["front"]
    )
    for item in answers.ALL:
        assert data[f"exit_{item.name}"].values.tolist() == [
            row[item.name] for row in found["exit"]["conditions"]
        ]


def test_data_hold_every_admissible_point_and_the_search_that_met_it(quick):
    data = _opened(quick[0])
    assert data.admissible_search.values.tolist() == [0, 0, 0, 1, 2, 2, 2, 3]
    for unknown in inputs.UNKNOWNS:
        shares = [
            unknown.share(value / unknown.factor)
            for value in data[f"admissible_{unknown.name}"].values
        ]
        assert shares == pytest.approx(2 * [0.4, 0.5, 0.6, 0.4], abs=1e-12)


def test_data_explain_themselves(quick):
    """Every variable has a name in words and, if it is a number, a unit, that of inputs the one
    they are printed with."""
    data = _opened(quick[0])
    for name, variable in data.variables.items():
        assert variable.attrs["long_name"]
        assert (
            variable.attrs["units"] if variable.dtype.kind in "fi" else name in ("axis", "change")
        )
    assert (
        data.end_clearance.attrs["units"] == "mm" and data.end_clearance.attrs["upper_bound"] == 0.5
    )
    assert data.end_offset_y.attrs["units"] == "1" and data.end_offset_y.attrs[
        "long_name"
    ].endswith("of the clearance")
    assert (
        data.change.values.tolist() == list(summary.CHANGES)
        and summary.CHANGES[0] == "k = 66000 N/mm^e"
    )
    assert data.radial_misalignment.values.tolist() == [0.0, 15.0, 35.0, 60.0, 90.0]


def test_no_admissible_point_is_none_in_the_data(tmp_path):
    studied(tmp_path, stub(admissible=(0, 0)), SMALL)
    data = _opened(Study(BASE, tmp_path, Settings(workers=1)))
    assert (
        data.sizes["point"] == 0 and data.sizes["search"] == 2 and np.isfinite(data.end_mass).all()
    )


@pytest.mark.parametrize(
    "harm", [lambda path: path.unlink(), lambda path: path.write_bytes(path.read_bytes()[:-1])]
)
def test_data_that_are_gone_or_damaged_are_made_again_without_a_search(quick, monkeypatch, harm):
    """Control: with whole data, nothing is written."""
    study, found = quick
    monkeypatch.setattr(solutions, "run", lambda *_: pytest.fail("searched again"))
    before, again = _opened(study), dataclasses.replace(SMALL, starts=2)
    with monkeypatch.context() as patched:
        patched.setattr(results, "save", lambda *_: pytest.fail("written again"))
        assert paper.run(study, again).document == found
    harm(study.path("paper.nc"))
    paper.run(study, again)
    assert _opened(study).identical(before)


def test_data_are_written_whole_or_not_at_all(quick, monkeypatch):
    study, _ = quick
    before = study.path("paper.nc").read_bytes()

    def stops(_):
        raise OSError("disk full")

    monkeypatch.setattr(os, "fsync", stops)
    left = exits.run(misfit.Launcher(BASE), np.full(COUNT, 0.5))
    with pytest.raises(OSError, match="disk full"):
        results.save(study.path("paper.nc"), [stub()(None, 0.0, 0, None, None)], 0, left)
    assert (
        study.path("paper.nc").read_bytes() == before
        and len(list(study.folder.glob("*paper.nc*"))) == 1
    )
