"""Studies take velocity and rates at the exit or settled: the rule, and the values of both."""

import json
import re

import numpy as np
import pytest
from pydantic import TypeAdapter
from typer.testing import CliRunner

import tipoff
from tests.studies import free_flight
from tests.studies.synthetic import flight
from tipoff.lowfi.ensemble.rows import Listed
from tipoff.mechanics import instant
from tipoff.mechanics.outcome import Outcome
from tipoff.scenes.names import NOMINAL
from tipoff.studies.cli import app
from tipoff.studies.limits.within import CasesAtScale
from tipoff.studies.measured import stage as measured
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.render import document
from tipoff.studies.runs import page
from tipoff.studies.runs import stage as runs
from tipoff.studies.runs.results import ConditionRun
from tipoff.studies.sensitivity.options import SensitivityOptions
from tipoff.studies.single import single
from tipoff.studies.single.text import Detail
from tipoff.studies.sweeps import stage as sweeps
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

FORCE, LASTS, OFF = 4000.0, 0.1, 1e-4  # N, s, m
ROW = {"thrust_offset.eccentricity.axial": OFF, "thrust_offset.eccentricity.radial": np.pi / 2.0}
TURNING = np.degrees(FORCE * OFF / free_flight.INERTIA)  # deg/s2


def burning():
    """A payload without contact whose constant thrust goes on after the exit."""
    push = {"kind": "constant", "force": FORCE, "duration": LASTS, "arm": 0.15}
    return free_flight.scene().replace({"thrust": push, "duration": 0.12, **free_flight.BRIEF})


def test_the_rule():
    """Above 1 % of the impulse after the exit the instant is the exit; a request comes first."""
    for share, at in ((0.0, "settled"), (0.01, "settled"), (0.0101, "exit"), (1.0, "exit")):
        assert instant.chosen(None, share).at == at
        for asked in (instant.EXIT, instant.SETTLED):
            assert instant.chosen(asked, share) == (asked, "as asked")
    assert instant.chosen(None, 0.25).words == (
        "at the exit, because 25 % of the impulse comes after the exit (more than 1 %)"
    )
    assert instant.chosen(None, None).at == instant.SETTLED


@pytest.mark.parametrize("asked", [None, "exit", "settled"])
def test_a_population_has_the_rates_of_its_instant(tmp_path, asked):
    """A push off the centre turns a free body at M t / I: the mean over 0.2 ms is the rate 0.1 ms
    after the exit, the settled one that of the whole push. The velocities are F t / m."""
    scene = burning()
    study, model = Study(scene, tmp_path, Settings(workers=1)), Surrogate(scene, None, None)
    watched = model.watched(asked)
    found = population.run(study, "trial", watched, Listed([ROW]), 1e-9)
    results, settled = found.results, asked == "settled"
    time = LASTS if settled else results.exit_time[0] + 1e-4
    assert results.exit_time[0] < 0.5 * LASTS  # Control: the two instants are not alike
    assert watched.instant.at == (asked or "exit") and found.settled.all()
    rate = answers.TOTAL_RATE.of(results)
    # a payload that nothing touches takes a few long steps, whose interpolant has 0.2 % of error
    assert rate == pytest.approx([TURNING * time], rel=1e-5 if settled else 5e-3)
    assert results.velocity[0, 0] == pytest.approx(FORCE * time / 10.0, rel=1e-5)
    said = population.Answering(**population.answering(study, found.model))
    assert f"rates {instant.where(watched.instant.at)}, " in population.model_line(said)


@pytest.mark.parametrize("lasts, at", [(LASTS, "exit"), (0.02, "settled")])
def test_a_single_run_answers_with_its_instant(tmp_path, capsys, lasts, at):
    """What the command, the table of conditions and Python print as the answer: rates under the thrust at the
    exit, and after them those of the whole push. Control: a push that ends on the rail."""
    scene = burning().replace({"thrust.duration": lasts} | ROW)
    made = single.run(Study(scene, tmp_path, Settings(workers=1)), NOMINAL, detail=Detail.ALL)
    printed = dict(line.strip().split(None, 1) for line in capsys.readouterr().out.splitlines())
    leaves = made["exit_time_s"]
    time = leaves + 1e-4 if at == "exit" else lasts
    rate, speed = TURNING * time, FORCE * time / 10.0
    numbers = [float(each) for each in re.findall(r"-?\d+\.\d+", printed["rate"])]
    assert numbers[-1] == pytest.approx(rate, rel=5e-3)
    assert float(printed["velocity"].split(",")[0]) == pytest.approx(speed, rel=1e-5)
    assert (", at the exit" in printed["rate"]) is ("burnt" in printed) is (at == "exit")
    if at == "exit":
        assert "by hand" not in printed and f"{TURNING * lasts:.3f}" in printed["burnt"]
        assert "in a vacuum" in printed["burnt"]
    (row,) = TypeAdapter(tuple[ConditionRun, ...]).validate_python([made])
    (table,) = page.draw([row])
    shown = dict(zip(table.heads, table.rows[0]))
    assert shown["values"] == instant.where(at)
    assert shown["v_x (m/s)"] == pytest.approx(speed, rel=1e-5)
    run = tipoff.run(scene, sensitivity=False)
    summary = dict(line.split(None, 1) for line in run.summary().splitlines())
    for text in (summary["rate"], repr(run).partition("rates")[2]):
        found = [float(each) for each in re.findall(r"-?\d+\.\d+", text)]
        assert np.linalg.norm(found[:3]) == pytest.approx(rate, rel=5e-3)
    assert float(summary["velocity"].split(",")[0]) == pytest.approx(speed, rel=1e-4)


def test_no_number_is_minus_zero():
    tiny = [-1e-9, -1e-9, -1e-9]
    found = Outcome(1e-2, 1e-2, tiny, tiny, 0.0, 0.0, tiny, exit_velocity=tiny, exit_rate=tiny)
    for outcome in (found, found._replace(impulse_after_exit=1.0)):
        run = flight(model="compliant", outcome=outcome)
        (table,) = page.draw([runs.row("one", run, "")])
        text = f"{run.summary()} {run!r} {document.terminal([table])} {document.markdown([table])}"
        assert "0.000" in text and "-0.0" not in text and "+0.0" not in text


def test_cases_within_tolerances_have_the_rates_of_the_instant(tmp_path):
    scene = burning()
    study, model = Study(scene, tmp_path, Settings(workers=1)), Surrogate(scene, None, None, 0)
    largest = {}
    for at in ("exit", "settled"):
        tried = CasesAtScale(
            study, "limits", model.watched(at), {"thrust_eccentricity": OFF}, 50, 1
        )
        largest[at] = abs(tried.rates(1.0)).max()
    assert largest["settled"] < TURNING * LASTS  # within three sigma
    assert 0.2 * largest["settled"] < largest["exit"] < 0.3 * largest["settled"]


def test_a_sweep_compares_with_a_free_payload_at_the_same_instant(tmp_path):
    """Without contact the rates are those of the free payload, at the exit as well as settled.
    Control: those of the other instant are more than twice as large."""
    scene, found = burning(), {}
    study = Study(scene, tmp_path, Settings(workers=1))
    for at in ("exit", "settled"):
        plain = sweeps.run(study, SensitivityOptions(sweep=8, at=at))
        launch = plain.result.launches[0]
        swept = next(each for each in launch.factors if each.name == "thrust_eccentricity")
        name = answers.TOTAL_RATE.name
        assert swept.departs_from_free_at is None
        assert swept.largest[name] == pytest.approx(swept.free[name], rel=0.02)
        found[at] = swept.free[name][0]
    assert found["settled"] > 2.0 * found["exit"]


def test_the_command_says_which_instant_and_why(tmp_path):
    """An ensemble of a motor that burns on: rates at the exit, unless the settled ones are asked
    for."""
    scene, table = tmp_path / "burning.toml", tmp_path / "cases.csv"
    scene.write_text(
        'extends = "reference"\nname = "burning"\ncontact = "absent"\nfriction = "absent"\n'
        'platform = "absent"\nduration = "0.12 s"\n[payload]\nmass = "10 kg"\n'
        '[thrust_offset.misalignment]\naxial = "0 deg"\n'
        f'[thrust]\nkind = "constant"\nforce = "{FORCE} N"\nduration = "{LASTS} s"\n'
    )
    table.write_text(
        "thrust_offset.eccentricity.axial,thrust_offset.eccentricity.radial\nmm,deg\n"
        "0.1,90\n0.2,90\n0.3,90\n"
    )
    arguments = ["ensemble", "--scene", scene, "--table", table, "--out", tmp_path]
    for option, at, words in (
        ([], "exit", "rates at the exit, because"),
        (["--at", "settled"], "settled", "rates settled, as asked"),
    ):
        found = CliRunner().invoke(app, [*map(str, arguments), *option], catch_exceptions=False)
        assert found.exit_code == 0 and words in found.output, found.output
        made = json.loads((tmp_path / "burning" / "ensemble.json").read_text())
        first = next(iter(made["quantiles"]))
        assert made["at"] == at
        assert first == {"exit": "exit_rate_deg_s", "settled": "rate_deg_s"}[at]
        settled, left = (
            made["quantiles"][f"{name}rate_deg_s"][1]["value"] for name in ("", "exit_")
        )
        assert settled > 2.0 * left


def test_a_drop_test_says_that_the_thrust_goes_on():
    """The settled rates of the cases are those after the thrust. Control: nothing is said of a thrust
    that ends on the rail."""
    (words,) = measured.pushed_on(np.array([0.3, 0.31, 0.32]))
    assert words.startswith("31 % of the impulse comes after the exit: windows.exit must be")
    assert measured.pushed_on(np.array([0.0, 0.01])) == []
