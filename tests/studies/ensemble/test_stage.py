"""The ``tipoff ensemble`` command: counts, a case alone, refused input, and a full disk."""

import errno
import json
import os
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy.stats import norm
from typer.testing import CliRunner

from tipoff import cache
from tipoff.scenes import uncertainty
from tipoff.studies.cli import app
from tipoff.studies.ensemble import page, sensitivity, stage
from tipoff.studies.render import table as tables


def call(*arguments, model="springs"):
    return CliRunner().invoke(
        app, ["ensemble", "--model", model, *(str(argument) for argument in arguments)]
    )


def test_compliant_contact_is_the_default(tmp_path):
    options = ("--scene", "tiny", "--cases", 8, "--out", tmp_path)
    default = CliRunner().invoke(app, ["ensemble", *map(str, options)])
    assert default.exit_code == 0, default.output
    assert (
        "tiny, model compliant: 8 cases" in default.stdout
        and "agreement: not measured for this scene" in default.stdout
    )
    assert default.stderr.count("rail compliance, once per rail and pads") == 1
    named = call(*options, model="compliant")
    assert "rail compliance" not in named.stderr and "all of them stored before" in named.stderr
    assert "tiny, model springs, with the scene's constants: 8 cases" in call(*options).stdout


def test_implausible_cases_of_a_table_are_said_and_stored(tmp_path):
    """Static friction below dynamic friction. Control: the scene and the other cases are plausible."""
    table = tmp_path / "cases.csv"
    table.write_text("friction.static,friction.dynamic\n0.3,0.2\n0.1,0.2\n0.2,0.2\n0.1,0.3\n")
    options = ("--scene", "tiny", "--out", tmp_path, "--table", table)
    found = call(*options)
    words = "friction.static, friction.dynamic: 0.1 and 0.2, plausible"
    assert found.exit_code == 0 and f"implausible: {words}" in found.stderr
    assert "(case 1, and 1 more of 4)" in found.stderr
    (stored,) = json.loads((tmp_path / "tiny" / "ensemble.json").read_text())["implausible"]
    assert stored.startswith(words)
    table.write_text("friction.static,friction.dynamic\n0.3,0.2\n0.2,0.2\n")
    assert "implausible" not in call(*options).stderr


def test_default_errors_run_and_are_kept(tmp_path):
    first = call("--cases", 300, "--out", tmp_path)
    assert first.exit_code == 0, first.output
    assert "300 cases = 300 ok + 0 refused + 0 failed" in first.stdout
    assert "truncated-normal" in first.stdout and "redraw" in first.stdout
    found = json.loads((tmp_path / "reference" / "ensemble.json").read_text())
    shown = TypeAdapter(stage.Ran).validate_python(found)
    assert tables.terminal(page.table_of_quantiles(shown)) in first.stdout
    assert (
        found["run"]["cases"] == found["settled"] == 300 and found["run"]["cpu_ms_per_case"] > 0.0
    )
    median = found["quantiles"]["rate_deg_s"][1]
    assert median["low"] < median["value"] < median["high"]
    assert found["quantiles"]["rate_deg_s"][-1]["high"] is None  # 300 runs hold no bound of 99.73 %
    assert found["provenance"]["mass_offset.eccentricity.axial"].startswith(
        "three sigma from the paper"
    )

    again = call("--cases", 300, "--out", tmp_path, "--json")
    assert (
        json.loads(again.stdout)["run"]["cases"] == 0
        and json.loads(again.stdout)["digest"] == found["digest"]
    )

    alone = call("--cases", 300, "--out", tmp_path, "--case", 123)
    assert alone.exit_code == 0 and "the stored result has the same bits" in alone.stdout
    assert call("--cases", 300, "--out", tmp_path, "--case", 300).exit_code == 2


def test_sensitivity_is_added_to_a_store_that_is_there(tmp_path, monkeypatch):
    """In a clock in which the cases take 1 s, those with more clearance 10 s, the tight ones 100 s:
    each cost stands apart. The counts are those of the columns in the store."""
    xarray, fill, seconds = pytest.importorskip("xarray"), stage.fill, [0.0]

    def slow(ensemble, *options):
        tight = ensemble.numerics.relative_tolerance < 1e-9
        seconds[0] += 10.0 if ensemble.widening else 100.0 if tight else 1.0
        return fill(ensemble, *options)

    monkeypatch.setattr(stage, "fill", slow)
    clock = SimpleNamespace(perf_counter=lambda: seconds[0], process_time=lambda: seconds[0])
    monkeypatch.setattr(stage, "time", clock)
    options = ("--cases", 200, "--out", tmp_path)
    plain = json.loads(call(*options, "--json").stdout)
    assert plain["sensitivity"] is None and plain["run"]["wall_s"] == 1.0
    result = call(*options, "--sensitivity")
    found = json.loads((tmp_path / "reference" / "ensemble.json").read_text())
    assert found["run"]["cases"] == 0 and found["digest"] == plain["digest"]
    told = found["sensitivity"]
    assert {cause: item["wall_s"] for cause, item in told["run"].items()} == {
        "clearance": 10.0,
        "tolerance": 100.0,
    }
    assert [item["cpu_ms_per_case"] for item in told["run"].values()] == [50.0, 500.0]
    assert "1 µm of clearance: 10 s for 200 cases" in result.stdout

    kept = xarray.open_zarr(f"{found['store']}/cases.zarr", consolidated=False, chunks=None)
    changes = {cause: np.degrees(kept[f"rate_change_by_{cause}"].values) for cause in told["run"]}
    above = {cause: change > 0.1 for cause, change in changes.items()}
    assert told["limit_deg_s"] == pytest.approx(0.1)
    for cause, change in changes.items():
        assert told["by"][cause]["above_limit"] == above[cause].sum()
        assert told["by"][cause]["largest_deg_s"] == pytest.approx(change.max())
    assert told["sensitive"] == (above["clearance"] | above["tolerance"]).sum()
    assert 0 < told["sensitive"] < 100  # some of the paper's errors, not most
    assert f"sensitive: {told['sensitive']} cases" in result.stdout

    alone = json.loads(call(*options, "--sensitivity", "--case", 7, "--json").stdout)
    assert alone["stored"] and alone["sensitivity"]["by"] == {
        cause: change[7] for cause, change in changes.items()
    }


def test_a_disturbed_run_that_does_not_settle_is_counted():
    """Of three cases one moves by more than the limit, one by less, one does not settle; a fourth
    never did, and is not counted."""
    rates = np.radians([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [np.nan] * 3])
    moved = rates + np.radians([[0.2, 0.0, 0.0], [0.0, 0.05, 0.0], [np.nan] * 3, [0.0] * 3])

    def store(rate):
        columns = {"rate": rate, "lateral_velocity": rate[:, 0]}

        class Held:
            asked = 4

            def __len__(self):
                return 2

            def bounds(self, number):
                return 2 * number, 2 * number + 2

            def column(self, name, begin=0, end=None):
                return columns[name][begin:end]

            def digest(self):
                return ""

        return Held()

    found = sensitivity.compared(
        store(rates), {"clearance": store(moved), "tolerance": store(rates)}, 0.1
    )
    assert found.sensitive == 2
    by = found.by["clearance"]
    assert (by.above_limit, by.unsettled) == (1, 1)
    assert by.largest_deg_s == pytest.approx(0.2)
    assert by.median_deg_s == pytest.approx(0.125)
    assert found.by["tolerance"].largest_deg_s == 0.0


def test_the_probability_above_limits(tmp_path):
    """The share of the cases with a rate above any limit, by the stored rates. Control: a lower limit has
    a larger share. A limit that is none is refused before anything runs."""
    xarray = pytest.importorskip("xarray")
    limits = ("--limit", "x=0.5 deg/s", "--limit", "3 deg/s")
    first = call("--cases", 300, "--out", tmp_path, *limits)
    assert first.exit_code == 0, first.output
    found = json.loads((tmp_path / "reference" / "ensemble.json").read_text())
    rates = np.degrees(
        xarray.open_zarr(f"{found['store']}/cases.zarr", consolidated=False).rate.values
    )
    count = int(((abs(rates[:, 0]) > 0.5) | (np.linalg.norm(rates, axis=1) > 3.0)).sum())
    above = found["above"]
    assert 0 < count < 300 and above["count"] == count and above["share"] == count / 300
    assert above["low"] < above["share"] < above["high"]
    alone = [int((abs(rates[:, 0]) > 0.5).sum()), int((np.linalg.norm(rates, axis=1) > 3.0).sum())]
    assert [item["count"] for item in above["each"]] == alone
    assert f"above total rate 3 deg/s: {100.0 * alone[1] / 300:.3g} % of the cases" in first.stdout
    for place, axis in enumerate("xyz"):
        shown = found["quantiles"][f"rate_{axis}_deg_s"][2]
        assert shown["share"] == 0.95
        assert shown["value"] == pytest.approx(np.quantile(abs(rates[:, place]), 0.95))
        assert f"about {axis}, size" in first.stdout
    assert {"rates.png", "rates.svg"} <= set(os.listdir(found["store"]))
    assert "any direction" in first.stdout  # the sizes of the errors stand beside them
    half = 0.4 / 3.0 * norm.ppf(0.5 + 0.5 * 0.95 * (2.0 * norm.cdf(3.0) - 1.0))
    assert f"0 to {half:.3g} deg" in first.stdout
    assert "above any of the limits rate about x 0.5 deg/s, total rate 3 deg/s: " in first.stdout
    assert "without a rate" not in first.stdout
    lost = replace(TypeAdapter(stage.Ran).validate_python(found), settled=297)
    assert "; 3 cases without a rate count as above" in str(page.summary(lost))
    # Control:
    lower = call("--cases", 300, "--out", tmp_path, "--limit", "1 deg/s", "--json")
    assert json.loads(lower.stdout)["above"]["count"] > count
    assert call("--out", tmp_path / "no", "--limit", "w=3").exit_code == 2
    assert not (tmp_path / "no").exists()


def test_bad_rows_are_refused_alone(tmp_path):
    table = tmp_path / "cases.csv"
    table.write_text(
        "thrust_offset.misalignment.axial,payload.mass\ndeg,kg\n0.1,9.9\n0.2,-1\nx,9.9\n0.3,9.8\n"
    )
    found = json.loads(call("--table", table, "--out", tmp_path / "out", "--json").stdout)
    assert found["counts"] == {"asked": 4, "ok": 2, "refused": 2, "failed": 0}
    assert [item["case"] for item in found["failures"]] == [1, 2]
    assert (
        "payload.mass" in found["failures"][0]["reason"]
        and found["failures"][1]["inputs"]["thrust_offset.misalignment.axial"] == "x"
    )
    assert all(row["low"] is None for row in found["quantiles"]["rate_deg_s"]) and found[
        "bounds"
    ].startswith("none")
    table.write_text("payload.mass\nkg\n-1\n")
    hopeless = call("--table", table, "--out", tmp_path / "out", "--sensitivity")
    assert hopeless.exit_code == 1 and "case 0: refused" in hopeless.stderr


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--vary", "no_such_file"], "paper"),
        (["--table", "missing.csv"], "missing.csv"),
        (["--tolerance", "0.5"], "--tolerance: value: given 0.5, expected 1e-13 to 0.01"),
        (["--table", "missing.csv", "--cases", "2"], "the table lists its cases"),
        (["--set", "payload.mass=-1 kg"], "payload.mass"),
    ],
)
def test_bad_input_is_refused_and_nothing_written(tmp_path, arguments, words):
    result = call("--out", tmp_path / "out", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr and "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


def test_bounds_are_not_claimed_for_points_that_depend_on_each_other(tmp_path):
    errors = (uncertainty.CATALOG / "paper.toml").read_text().replace('"random"', '"sobol"')
    (tmp_path / "errors.toml").write_text(errors)
    vary = ("--vary", tmp_path / "errors.toml", "--cases", 16)
    found = json.loads(call(*vary, "--out", tmp_path, "--json").stdout)
    assert "sobol" in found["bounds"] and found["quantiles"]["rate_deg_s"][1]["low"] is None


def test_a_full_disk_is_exit_code_1_and_a_message(tmp_path, monkeypatch):
    def full(path, value):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(cache, "write_json", full)
    result = call("--cases", 20, "--out", tmp_path)
    assert result.exit_code == 1
    assert (
        "No space left on device" in result.stderr
        and "the same command goes on from there" in result.stderr
    )
    assert "Traceback" not in result.output
    monkeypatch.undo()
    assert call("--cases", 20, "--out", tmp_path).exit_code == 0
    (store,) = (tmp_path / "reference").glob("ensemble-*")
    (store / "cases.zarr" / "zarr.json").write_text("{")
    again = call("--cases", 20, "--out", tmp_path)
    assert (
        again.exit_code == 0
        and "zarr.json is damaged or was edited: it is written again" in again.stderr
    )
    (store / "cases.zarr" / "zarr.json").write_text("{")
    (store / "done" / "000000.json").unlink()  # now nothing says whose store this is
    assert call("--cases", 20, "--out", tmp_path).exit_code == 1


def test_cases_that_do_not_leave_say_how_they_ended(tmp_path):
    """Without a stated duration a payload that nothing moves is jammed, in every case."""
    changed = ("--set", "thrust.peak=0 N", "--set", "duration=absent")
    found = call("--scene", "tiny", "--cases", 4, *changed, "--out", tmp_path)
    assert found.exit_code == 0, found.output
    assert "0 left the rail and settled, 4 jammed" in " ".join(found.stdout.split())
