"""The 95 % range of a launch under the random errors that its scene states."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.studies import free_flight
from tipoff.scenes import SceneError, load
from tipoff.studies.ensemble import stage as ensemble
from tipoff.studies.nominal import page, spread
from tipoff.studies.populations import answers
from tipoff.studies.render.document import terminal
from tipoff.workspace.settings import Settings, defaults
from tipoff.workspace.study import Study

TILT = """cases = 10
seed = 3
sampling = "sobol"

[vary."thrust_offset.misalignment.axial"]
distribution = "uniform"
low = "0 deg"
high = "0.4 deg"
"""


@pytest.fixture
def tilted(tmp_path):
    """A launch in free flight whose thrust is tilted by up to 0.4 deg, all values alike."""
    (tmp_path / "tilt.toml").write_text(TILT)
    return free_flight.scene().replace({"studies.errors": str(tmp_path / "tilt.toml")})


def study(scene, folder):
    return Study(scene, folder / "out", Settings(workers=2))


def test_the_range_of_a_launch_whose_distribution_is_known(tilted, tmp_path):
    """A uniform tilt gives a uniform rate. One percent of the range is four standard deviations of an
    end. Control: the quantiles 5 and 95 %, and the number of cases of the file, are further off."""
    found = spread.of_scene(study(tilted, tmp_path), tilted)
    assert found.settled == found.cases == spread.CASES[0]
    largest = math.radians(0.4) * free_flight.RATE_PER_RADIAN
    for name, sign in (("rate_deg_s", 1.0), ("rate_z_deg_s", -1.0)):
        ends = found.ranges[name]
        exact = sorted((0.025 * sign * largest, 0.975 * sign * largest))
        assert [ends.low, ends.high] == pytest.approx(exact, abs=0.01 * largest)
        assert ends.low_bounds[0] < ends.low < ends.low_bounds[1]
        # Control:
        assert abs(0.05 * largest - min(map(abs, exact))) > 0.01 * largest
    across = found.ranges["rate_y_deg_s"]
    assert max(map(abs, (across.low, across.high))) < 1e-3 * largest


def test_a_scene_without_errors_has_no_range_and_the_page_says_how_to_state_them(tmp_path):
    scene = free_flight.scene().replace({"studies": None})
    assert spread.of_scene(study(scene, tmp_path), scene) is None
    said = terminal(page.ranges(None))
    assert "no range is known" in said and 'errors = "paper"' in said


def test_errors_that_do_not_fit_the_scene_are_refused(tmp_path):
    (tmp_path / "bad.toml").write_text(TILT.replace("axial", "axis"))
    scene = free_flight.scene().replace({"studies.errors": str(tmp_path / "bad.toml")})
    with pytest.raises(SceneError, match="misalignment.axis"):
        spread.of_scene(study(scene, tmp_path), scene)


def drawn(draw, settled=1.0):
    """A stand-in for the population: total rates by ``draw``, of which a share settled."""

    def run(_study, _name, _model, source):
        n, random = source.asked, np.random.default_rng(1)
        values, there = draw(random, n), random.random(n) < settled
        results = SimpleNamespace(
            rate=np.radians(np.outer(values, [1.0, 0.0, 0.0])),
            velocity=np.ones((n, 3)),
            exit_time=np.where(there, 1e-2, np.nan),
        )
        return SimpleNamespace(results=results, settled=there, store="errors-x")

    return run


@pytest.mark.parametrize(
    "draw, cases",
    [
        (lambda random, n: random.normal(size=n), 4000),
        (lambda random, n: random.standard_t(1.5, n), 16_000),
    ],
    ids=["normal", "heavy tails"],
)
def test_more_cases_are_drawn_where_the_ends_are_not_known_well(
    draw, cases, tilted, tmp_path, monkeypatch
):
    monkeypatch.setattr("tipoff.studies.populations.population.run", drawn(draw))
    found = spread.of_scene(study(tilted, tmp_path), tilted)
    assert found.cases == cases


def test_cases_that_did_not_settle_are_said(tilted, tmp_path, monkeypatch):
    normal = drawn(lambda random, n: random.normal(size=n), settled=0.9)
    monkeypatch.setattr("tipoff.studies.populations.population.run", normal)
    found = spread.of_scene(study(tilted, tmp_path), tilted)
    said = terminal(page.ranges(found))
    assert f"{found.cases - found.settled:,} of them" in said and "did not leave and settle" in said
    few = drawn(lambda random, n: random.normal(size=n), settled=0.01)
    monkeypatch.setattr("tipoff.studies.populations.population.run", few)
    found = spread.of_scene(study(tilted, tmp_path), tilted)
    assert found.ranges is None and "No range" in terminal(page.ranges(found))


def test_bounds_of_the_ends_hold_the_true_quantiles():
    random = np.random.default_rng(5)
    held = 0
    for _ in range(200):
        found = spread.range_of(random.normal(size=4000))
        held += found.low_bounds[0] <= -1.959964 <= found.low_bounds[1]
    assert 180 <= held <= 199  # 95 % of 200, three standard deviations


def test_errors_are_inherited_and_read_beside_the_scene_file(tmp_path):
    (tmp_path / "tilt.toml").write_text(TILT)
    own = tmp_path / "own.toml"
    own.write_text('extends = "tiny"\n[studies]\nerrors = "tilt.toml"\n')
    scene = load(own)
    assert scene.studies.errors == str((tmp_path / "tilt.toml").resolve())
    assert defaults(scene) == defaults("tiny")  # no setting of a solver
    assert load("tiny").studies.errors == "paper"
    assert scene.hash == load("tiny").hash


def test_an_ensemble_without_a_file_draws_the_errors_of_the_scene(tilted, tmp_path):
    """Control: a scene without errors draws those of the paper."""
    asked, _ = ensemble.request(study(tilted, tmp_path), ensemble.EnsembleOptions())
    assert asked.source.keys == ["thrust_offset.misalignment.axial"] and asked.source.asked == 10
    plain = tilted.replace({"studies": None})
    asked, _ = ensemble.request(study(plain, tmp_path), ensemble.EnsembleOptions())
    assert len(asked.source.keys) == 6


def test_total_rate_and_rates_come_first():
    assert [item.name for item in spread.QUANTITIES][:4] == [
        item.name for item in (answers.TOTAL_RATE, *answers.RATES)
    ]
