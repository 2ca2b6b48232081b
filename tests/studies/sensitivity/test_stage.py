"""The ``tipoff sensitivity`` command: tables, indices, figures, refused input, and the section of
the page."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies import kept
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.columns import STATUSES
from tipoff.scenes import load
from tipoff.studies.cli import app
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.render import document
from tipoff.studies.sensitivity import page
from tipoff.studies.sensitivity import stage as sensitivity
from tipoff.studies.sensitivity.indices import Indices
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study, StudyError, read

TOLERANCES = """
[vary."thrust_offset.misalignment.y"]
distribution = "normal"
mean = "0.1 deg"
sd = "0.03 deg"
provenance = "a guess"

[vary."thrust_offset.misalignment.z"]
distribution = "uniform"
low = "0 deg"
high = "0.001 deg"

[factor."friction.dynamic"]
distribution = "uniform"
low = "0.9"
high = "1.1"

[factor."payload.inertia.yz"]
distribution = "uniform"
low = "0.9"
high = "1.1"
"""


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """Arguments of the command; the constants of the scene replace a fit."""
    monkeypatch.setattr(
        population, "surrogate", lambda study, *_: Surrogate(study.scene, None, None)
    )
    (tmp_path / "mine.toml").write_text(TOLERANCES)
    return [
        "sensitivity",
        "--scene",
        "tiny",
        "--points",
        "64",
        "--workers",
        "1",
        "--vary",
        str(tmp_path / "mine.toml"),
        "--out",
        str(tmp_path / "out"),
    ]


def call(arguments):
    return CliRunner().invoke(app, arguments, catch_exceptions=False)


def test_the_command(tiny, tmp_path, monkeypatch):
    result = call(tiny)
    assert result.exit_code == 0 and "320 cases of 3 inputs, 0 did not settle" in result.stdout
    kept = read(tmp_path / "out" / "tiny" / "sensitivity.json")
    found = sensitivity.STAGE.read(kept)
    (table,) = found.tables  # nothing was calibrated, so no second one
    assert [row.condition for row in table.rows[::8]] == ["phi15", "phi60"]
    assert len(table.rows) == 16
    assert (
        max(table.largest.absolute_deg_s) > 0.0
        and max(table.largest_clearance.absolute_deg_s) > 0.0
    )
    for row in table.rows:
        assert list(row.values) == list(row.moved) == [item.name for item in answers.ALL]
        assert [row.values[f"rate_{axis}_deg_s"] for axis in "xyz"] == list(row.rate_deg_s)
    # the first condition, without the clearance
    attitude = [row.values["attitude_y_deg"] for row in table.rows[:7]]
    assert (
        table.most_moved["attitude_y_deg"]
        >= max(abs(value - attitude[0]) for value in attitude)
        > 0.0
    )
    sobol = found.sobol
    assert [item.name for item in sobol.quantities] == [item.name for item in answers.ALL]
    assert [item.key for item in sobol.inputs] == [
        "thrust_offset.misalignment.y",
        "thrust_offset.misalignment.z",
        "friction.dynamic",
    ]
    assert (
        sobol.inputs[0].provenance == "a guess" and "zero" in sobol.left_out["payload.inertia.yz"]
    )
    about_z = next(item for item in sobol.quantities if item.name == "rate_z_deg_s")
    assert np.argmax(about_z.indices.total) == 0 and about_z.indices.total[1] < 0.1
    assert [step.base_points for step in about_z.convergence] == [8, 16, 32, 64]
    assert about_z.convergence[-1].total == about_z.indices.total
    assert {
        f"sensitivity-{name}.{kind}"
        for name in ("indices", "map", "convergence")
        for kind in ("png", "svg")
    } == {path.name for path in (tmp_path / "out" / "tiny" / "figures").iterdir()}
    assert (
        sensitivity.STAGE.stored(
            Study(load("tiny"), tmp_path / "out" / "tiny", defaults("tiny"))
        ).document
        == kept
    )
    monkeypatch.setattr(population, "surrogate", lambda *_: pytest.fail("made again"))
    assert json.loads(call([*tiny, "--json"]).stdout) == kept
    (tmp_path / "mine.toml").unlink()
    assert (
        sensitivity.STAGE.stored(Study(load("tiny"), tmp_path / "out" / "tiny", defaults("tiny")))
        is None
    )


def test_tables_of_warm_rails_have_the_walls_of_the_model(tmp_path, monkeypatch):
    """Both the calibrated constants and those of the scene. Constants of the law change, not the
    interface stiffness of compliant contact."""
    models = []

    def run(_study, _name, model, source, _tolerance):
        models.append(model)
        rates = np.zeros((source.asked, 3))
        found = columns.Columns(
            *[rates if name in columns.VECTORS else rates[:, 0] for name in columns.Columns._fields]
        )
        return Population({}, found, "store", {}, model)

    monkeypatch.setattr(population, "run", run)
    study = Study(
        load("reference").replace({"thermal.mean": "15 K"}), tmp_path, defaults("reference")
    )
    rigid = SimpleNamespace(flexibility=None)
    model = Surrogate(study.scene.replace({"contact.stiffness": 1e9}), None, rigid)
    made = sensitivity.tables(study, model)
    assert [found.compliance for found in models] == [rigid] * 2 and len(made) == 2
    assert models[1].scene.contact == study.scene.contact
    for table in made:
        assert {row.symbol for row in table.rows} == {"baseline", "k", "c", "d", "clearance"}
    (compliant,) = sensitivity.tables(
        study, model._replace(compliance=SimpleNamespace(flexibility=1.0))
    )
    assert {row.symbol for row in compliant.rows} == {
        "baseline",
        "interface stiffness",
        "clearance",
    }


def test_cases_that_do_not_settle(tiny, tmp_path, monkeypatch):
    """A few are counted and left out with their base points; too many are a StudyError. Figures are
    drawn in another test."""
    run = population.run
    monkeypatch.setattr(sensitivity, "with_figures", lambda found, *_: (found, []))

    def spoilt(cases):
        def one(*arguments):
            found = run(*arguments)
            if found.counts["asked"] == 320:
                for name in (
                    "exit_time",
                    "rate",
                    "lateral_velocity",
                    "direction_error",
                    "exit_attitude",
                ):
                    getattr(found.results, name)[cases] = np.nan
                found.results.status[cases] = STATUSES.index("jammed")
            return found

        return one

    monkeypatch.setattr(population, "run", spoilt([0, 1, 7]))
    found = json.loads(call([*tiny, "--json"]).stdout)["sobol"]
    assert (found["not_settled"], found["used"], found["base_points"]) == (3, 62, 64)
    assert all(item["indices"]["points"] == 62 for item in found["quantities"] if item["indices"])
    monkeypatch.setattr(population, "run", spoilt(np.arange(0, 320, 7)))
    with pytest.raises(StudyError, match="too few"):
        study = Study(load("tiny"), tmp_path / "again", defaults("tiny"))
        sensitivity.run(
            study, sensitivity.SensitivityOptions(str(tmp_path / "mine.toml"), points=64)
        )


def test_bad_input_is_listed_whole_and_nothing_written(tiny, tmp_path):
    wrong = TOLERANCES
    for right, slip in (
        ('low = "0.9"', 'low = "0.9 mm"'),
        ("misalignment.z", "misalignment.q"),
        ('"normal"', '"gauss"'),
    ):
        wrong = wrong.replace(right, slip)
    (tmp_path / "mine.toml").write_text(wrong + "\n[shift]\na = 1\n")
    result = call([*tiny, "--points", "100"])
    assert result.exit_code == 2 and not (tmp_path / "out").exists()
    for words in (
        "--points",
        "factor.friction.dynamic.low",
        "factor.payload.inertia.yz.low",
        "vary.thrust_offset.misalignment.q",
        "'gauss'",
        "shift",
    ):
        assert words in result.stderr
    (tmp_path / "mine.toml").write_text(
        '[factor."payload.inertia.yz"]\ndistribution = "uniform"\nlow = "1"\nhigh = "2"\n'
    )
    assert "at least one number that varies" in call(tiny).stderr
    assert (
        call(
            [*tiny[:-4], "--vary", str(tmp_path / "nowhere.toml"), "--out", str(tmp_path / "out")]
        ).exit_code
        == 2
    )


def test_an_index_below_its_noise_is_not_resolved():
    """Sums of first-order indices, and total indices, beside the half widths of their intervals."""
    kept_ = kept.result(sensitivity.STAGE)
    width = len(kept_.sobol.inputs)

    def shown(first: float, half: float, total: float, total_half: float) -> tuple:
        indices = Indices(
            first=(first,) + (0.0,) * (width - 1),
            first_half_width=(0.1,) * width,
            total=(total,) + (0.0,) * (width - 1),
            total_half_width=(total_half,) + (0.1,) * (width - 1),
            points=64,
        )
        item = replace(kept_.sobol.quantities[0], indices=indices, first_sum_half_width=half)
        table = page.table_of_indices(replace(kept_.sobol, quantities=(item,)))
        text = document.terminal([table]).splitlines()
        return next(line for line in text if line.startswith(" rate about x"))

    assert "not resolved (± 52)   not resolved" in shown(-0.971, 0.52, 0.2, 0.3)
    assert "not resolved (± 52)" in shown(0.5, 0.52, 0.9, 0.3)
    assert "75 ± 12" in shown(0.75, 0.12, 0.9, 0.3) and "0.9 ± 0.3" in shown(0.75, 0.12, 0.9, 0.3)
    assert "-" not in shown(-0.971, 0.52, -0.2, 0.3).partition("not resolved")[2]
