"""Tolerances that keep limits, on a launch without contact, where the total rate is proportional to
the one error that varies."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray
from scipy import stats
from typer.testing import CliRunner

from tests.studies import free_flight
from tests.studies.agreement.made import ROW, table
from tests.studies.limits import in_memory
from tests.studies.shown import html
from tipoff.lowfi.ensemble.rows import numbers
from tipoff.scenes import load
from tipoff.scenes.calibration import Calibration
from tipoff.studies.agreement import verdicts
from tipoff.studies.cli import app
from tipoff.studies.limits import constants, search, within
from tipoff.studies.limits import page as pictures
from tipoff.studies.limits import stage as limits
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.limits.within import ADVISED
from tipoff.studies.populations import answers, exceedance
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.render import chart, document
from tipoff.studies.render import table as tables
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

LIMIT, PROBABILITY = 6.0, 0.9
QUICK = LimitsOptions(limits=("6 deg/s",), probability=PROBABILITY, cases=120)
FITTED = Calibration({}, [], [], [], [], [], [], np.zeros((0, 0)), [], {}, [], 0.0)
PER_UNIT = {
    "misalignment": np.radians(free_flight.RATE_PER_RADIAN),
    "thrust_eccentricity": 1e-3 * free_flight.RATE_PER_METRE,
    "mass_eccentricity": 1e-3 * free_flight.RATE_PER_METRE,
}  # deg/s per deg, mm, mm


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return Study(free_flight.scene(), tmp_path_factory.mktemp("out"), Settings(workers=2))


@pytest.fixture(scope="module")
def found(study):
    """Two draws of the constants make the arm 10 % longer and shorter, and the model is off by 1
    deg/s."""
    with pytest.MonkeyPatch.context() as patch:
        in_memory.keep(patch, written=30)
        patch.setattr(
            limits.population, "surrogate", lambda study, *_: Surrogate(study.scene, FITTED, None)
        )
        patch.setattr(
            limits.constants,
            "draws",
            lambda *_: (
                [{"thrust.arm": factor * free_flight.ARM} for factor in (0.9, 1.1)],
                ["arm"],
            ),
        )
        patch.setattr(
            limits.constants,
            "margin",
            lambda *_: constants.Margin(dict.fromkeys(("x", "y", "z", "total"), 1.0), "assumed"),
        )
        patch.setattr(limits, "RAYS", 3)
        return of(study, QUICK)


def of(study, options):
    """The result of a study."""
    return limits.run(study, options).result


def row_of(found, name):
    return next(row for row in found.rows if row.name == name)


def certified(study, name, cases, limit=LIMIT):
    """Largest tolerance in closed form: the first draw that must keep the limit is at the limit."""
    allowed = exceedance.allowed(cases, PROBABILITY, 0.95)
    source = within.source(study.scene, {name: 1.0}, cases, 1)
    sizes = np.sort(
        numbers(source.keys, source.rows(0, cases))[
            :, source.keys.index(f"{within.ERRORS[name].key}.axial")
        ]
    )
    return limit / (PER_UNIT[name] * sizes[cases - 1 - allowed])


def combined(study, tolerances, cases):
    """Total rates (n,), deg/s, of all errors within ``tolerances`` (SI), none of the others."""
    source = within.source(study.scene, dict.fromkeys(ADVISED, 0.0) | tolerances, cases, 1)
    drawn = dict(zip(source.keys, numbers(source.keys, source.rows(0, cases)).T))
    (t, a), (r, b), (m, c) = (
        (drawn[f"{error.key}.axial"], drawn[f"{error.key}.radial"])
        for error in within.ERRORS.values()
    )
    y = free_flight.RATE_PER_RADIAN * t * np.sin(a) + free_flight.RATE_PER_METRE * (
        r * np.cos(b) - m * np.cos(c)
    )
    z = free_flight.RATE_PER_RADIAN * t * np.cos(a) + free_flight.RATE_PER_METRE * (
        r * np.sin(b) - m * np.sin(c)
    )
    return np.hypot(y, z)


@pytest.mark.parametrize("name", sorted(PER_UNIT))
def test_one_factor_alone_is_the_closed_form(study, found, name):
    row, exact = row_of(found, name).nominal, certified(study, name, found.cases)
    # The search stops within 1.1 %; the rates themselves carry the step error of 1e-2 settings, a
    # thousandth.
    assert 1.0 / 1.013 < row.tolerance / exact < 1.002 and not row.falls and not row.again
    beside = {item.name: item for item in row_of(found, name).beside}
    assert beside["rate_deg_s"].value < LIMIT
    # The law itself: the share that is truly above at the certified size is no more than allowed,
    # and no less than the rank of the draw that lies on the limit lets it be, beta distributed (one
    # chance in a thousand).
    above = stats.truncnorm(0.0, 3.0).sf(3.0 * LIMIT / (PER_UNIT[name] * row.tolerance))
    least = stats.beta(found.allowed + 1, found.cases - found.allowed).ppf(1e-3)
    assert least < above < 1.0 - PROBABILITY


def test_constants_and_the_model_error_scale_the_tolerance_as_in_the_equation(study, found):
    """Rate = J l t / I: the tolerance is inverse to the arm, and a margin of 1 of 6 deg/s reduces
    it by a sixth. Searches from a start are within 2.8 %."""
    row = row_of(found, "misalignment")
    nominal = certified(study, "misalignment", found.cases)
    for answer, expected in (
        (row.constants[0], nominal / 0.9),
        (row.constants[1], nominal / 1.1),
        (row.model, nominal * 5.0 / 6.0),
        (row.both, nominal / 1.1 * 5.0 / 6.0),
    ):
        assert 1.0 / 1.03 < answer.tolerance / expected < 1.002
    straight = row_of(found, "mass_eccentricity")  # which no arm touches
    assert len({item.tolerance for item in straight.constants}) == 1


def test_a_set_is_certified_by_its_rates(study, found):
    """The multiple of the set, recomputed from the rate of each case in closed form."""
    row, cases = row_of(found, "together"), found.cases
    rates = combined(study, ADVISED, cases)
    assert (
        1.0 / 1.013
        < row.nominal.tolerance / (LIMIT / np.sort(rates)[cases - 1 - found.allowed])
        < 1.002
    )
    assert row.advised.above == int((rates > LIMIT).sum()) and row.advised.tolerance == 1.0


def test_the_map_agrees_with_the_rates_of_its_pairs(study, found):
    """Each pair in closed form: certified there, and not 2.8 % beyond; on the axes one error is
    zero."""
    for x, y in (point.tolerances for point in found.map.points):
        sizes = {"misalignment": np.radians(x), "mass_eccentricity": 1e-3 * y}
        rates = np.sort(combined(study, sizes, found.cases))
        assert 0.998 < LIMIT / rates[found.cases - 1 - found.allowed] < 1.03
    points = np.array([point.tolerances for point in found.map.points])
    assert points[0, 1] == points[-1, 0] == 0.0 and found.map.advised == pytest.approx([0.2, 0.2])
    assert (np.diff(points[:, 0]) < 0.0).all() and (np.diff(points[:, 1]) > 0.0).all()


def test_limits_that_no_tolerance_or_every_tolerance_keeps_are_reported(study, monkeypatch):
    """0.3 mm of thrust eccentricity alone give 3.1 deg/s: no misalignment keeps 2 deg/s unless that
    error is zero."""
    monkeypatch.setattr(limits, "RAYS", 1)
    monkeypatch.setattr(chart, "to_files", lambda *_: [])  # drawn in another test
    in_memory.keep(monkeypatch)
    offset = Study(
        study.scene.replace({"thrust_offset.eccentricity.axial": 0.3e-3}),
        study.folder,
        study.settings,
    )
    for others, state in (("scene", "none"), ("zero", "found")):
        found = of(
            offset,
            LimitsOptions(limits=("2 deg/s",), probability=PROBABILITY, cases=30, others=others),
        )
        assert row_of(found, "misalignment").nominal.state == state and (found.map is None) == (
            state == "none"
        )
        assert row_of(found, "thrust_eccentricity").nominal.state == "found"
        shown = document.markdown(pictures.draw(found))
        assert ("exceeded even at zero" in shown) == (state == "none")
    monkeypatch.setattr(
        limits.constants,
        "margin",
        lambda *_: constants.Margin(dict.fromkeys(("x", "y", "z", "total"), 1.0), ""),
    )
    far = of(offset, LimitsOptions(limits=("x=1 deg/s",), probability=PROBABILITY, cases=30))
    row = row_of(far, "misalignment")
    assert row.nominal.state == "all" and row.model.state == "lost"
    assert "all" in pictures.value(row.nominal) and "model error" in pictures.value(row.model)


def test_values_are_kept_with_names_units_and_scale(study, found, monkeypatch):
    """A whole file is only read; a damaged one is made again with the same values."""
    folder, model = study.folder / "limits", Surrogate(study.scene, None, None)

    def values_again():
        tolerances = {"misalignment": 0.01}
        return within.CasesAtScale(study, limits.NAME, model, tolerances, 20, 3).values(0.5)

    before = set(folder.glob("*.nc"))
    values = values_again()
    assert not list(folder.glob("*.npy")) and len(before) > 20
    (path,) = set(folder.glob("*.nc")) - before
    kept = xarray.load_dataset(path, engine="h5netcdf")
    assert kept["value"].dims == ("case", "quantity") and kept.sizes["case"] == 20
    assert kept.attrs["scale"] == 0.5
    assert kept["quantity"].values.tolist() == [item.name for item in answers.ALL]
    assert kept["units"].values.tolist() == [item.unit for item in answers.ALL]
    assert json.loads(kept.attrs["tolerances_si"]) == {"misalignment": 0.005}
    assert np.array_equal(kept["value"], values, equal_nan=True)
    path.write_bytes(path.read_bytes()[:600])
    assert np.array_equal(values_again(), values, equal_nan=True)
    monkeypatch.setattr(within, "completed", lambda *_: pytest.fail("ran again"))
    assert np.array_equal(values_again(), values, equal_nan=True)
    for row in found.rows:
        assert [item.name for item in row.beside] == [item.name for item in answers.ALL]


def searches(study, options):
    model, margin = Surrogate(study.scene, None, None), constants.Margin(None, "")
    of_limits = exceedance.limits(options.limits)
    return limits.Search(study, options, of_limits, options.cases, model, margin, lambda _: None)


@pytest.mark.parametrize("vary, beside", [(None, 0.2), ("paper", 1.0)])
def test_the_advice_of_the_paper_stands_beside_its_set_alone(study, monkeypatch, vary, beside):
    """Beside the tolerances of a file stand those that it states, once each."""
    options = LimitsOptions(limits=("6 deg/s",), probability=PROBABILITY, cases=30, vary=vary)
    monkeypatch.setattr(within.CasesAtScale, "values", lambda *_: np.zeros((30, len(answers.ALL))))
    monkeypatch.setattr(limits.Search, "pairs", lambda *_: None)
    found = searches(study, options).all()
    first, *_, last = found.rows
    assert first.advised.tolerance == pytest.approx(beside) and last.advised.tolerance == 1.0
    assert ("the paper advises" in pictures.table_of(found).heads) == (vary is None)


def test_a_factor_without_a_trial_above_zero_has_no_curve(found):
    """The control: the others have one."""
    row = replace(found.rows[0], nominal=search.Found(search.LOST))
    curves, *_ = pictures.figures(replace(found, rows=(row, *found.rows[1:])))
    assert len(curves.chart.panels) == len(found.rows) - 1
    assert all(
        each.chart.name != "limits-curves" for each in pictures.figures(replace(found, rows=(row,)))
    )


def test_section_of_the_page(study, found):
    shown = html(pictures.draw(found))
    assert (
        "limits-curves" in shown
        and "limits-map" in shown
        and "assumed" in shown
        and "thrust misalignment" in shown
    )
    assert tables.terminal(pictures.table_of(found)) in document.terminal(pictures.draw(found))
    assert {f"limits-{name}.{kind}" for name in ("curves", "map") for kind in ("png", "svg")} == {
        path.name for path in study.path("figures").iterdir()
    }


@pytest.mark.case("O49")
def test_too_few_cases_and_nonsense_are_refused_with_every_fault(tmp_path):
    arguments = ["limits", "--out", str(tmp_path / "out")]
    for more, words in (
        (["--probability", "0.99", "--cases", "100"], ("--cases", "299 or more")),
        (["--probability", "0.9973", "--cases", "1108"], ("1,109 or more",)),
        (
            ["--probability", "1.5", "--confidence", "0", "--limit", "q=1 deg/s"],
            ("--probability", "--confidence", "--limit", "3 faults"),
        ),
        (["--limit", "x=1 deg/s", "--limit", "x=2 deg/s"], ("two limits",)),
        (
            ["--condition", "phi99", "--limit", "q=1 deg/s"],
            ("phi99", "--limit", "2 faults"),
        ),
    ):
        result = CliRunner().invoke(app, arguments + more)
        assert result.exit_code == 2 and all(word in result.stderr for word in words), result.output
        assert "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


def test_clearance_and_friction_vary_about_their_nominal_values():
    scene = load("reference")
    assert list(within.factors(scene)) == [*ADVISED, "clearance", "friction"]
    assert list(within.factors(free_flight.scene())) == list(ADVISED)
    source = within.source(
        scene.replace({"friction.static": 0.3}), {"clearance": 0.1e-3, "friction": 0.05}, 2000, 1
    )
    drawn = dict(zip(source.keys, numbers(source.keys, source.rows(0, 2000)).T))
    gaps = drawn["contact.clearance"]
    assert np.abs(gaps - 0.25e-3).max() <= 0.1e-3 and gaps.mean() == pytest.approx(
        0.25e-3, rel=0.01
    )
    assert drawn["friction.dynamic"].std() == pytest.approx(
        0.05 / 3.0 * np.sqrt(0.9733369), rel=0.05
    )
    assert np.allclose(drawn["friction.static"], 1.5 * drawn["friction.dynamic"])
    # the same draws, whatever else varies
    more = within.source(scene, {"clearance": 0.2e-3}, 2000, 1).rows(0, 2000)
    assert np.allclose([row["contact.clearance"] - 0.25e-3 for row in more], 2.0 * (gaps - 0.25e-3))


def test_clearances_along_the_axes_vary_together():
    axes = {"contact.clearance_y": 1e-4, "contact.clearance_z": 2e-4}
    scene = load("reference").replace(axes)
    assert within.factors(scene)["clearance"].most == 1e-4
    row = within.source(scene, {"clearance": 1e-4}, 8, 1).rows(0, 8)[3]
    added = row["contact.clearance_y"] - 1e-4
    assert 0.0 < abs(added) < 1e-4 and "contact.clearance" not in row
    assert row["contact.clearance_z"] - 2e-4 == pytest.approx(added)


def test_constants_are_drawn_inside_their_intervals_and_others_stay():
    scene, endless = load("reference"), float("inf")
    fitted = Calibration(
        {},
        ["contact.force", "contact.exponent", "contact.damping", "friction.dynamic"],
        [600.0, 1.0, 0.0, 0.2],
        ["N", "1", "N*s/m", "1"],
        [20.0, 1.0, 0.0, 0.05],
        [6720.0, 2.2, 7000.0, 0.5],
        [],
        np.zeros((0, 0)),
        [],
        {},
        [],
        0.0,
        intervals=[[500.0, 700.0], [-endless, endless], [-endless, endless], [0.19, 0.21]],
    )
    found, names = constants.draws(scene, fitted, 400, 1)
    assert names == ["contact.force", "friction.dynamic"] and len(found) == 400
    friction = np.array([item["friction.dynamic"] for item in found])
    assert 0.19 <= friction.min() < friction.max() <= 0.21 and friction.std() == pytest.approx(
        0.01 / 1.96, rel=0.15
    )
    force = np.array([item["contact.stiffness"] * 2e-5 for item in found])
    assert (
        500.0 <= force.min() < force.max() <= 700.0
        and abs(np.corrcoef(force, friction)[0, 1]) < 0.2
    )
    assert {item["contact.exponent"] for item in found} == {1.0} and all(
        item["friction.static"] == item["friction.dynamic"] for item in found
    )
    assert constants.draws(scene, fitted, 0, 1) == ([], [])


def test_the_model_error_is_the_largest_of_the_held_out_conditions(tmp_path, monkeypatch):
    study = Study(load("reference"), tmp_path, Settings())
    assert (
        constants.margin(study, "springs").deg_s is None
        and "tipoff compare" in constants.margin(study, "springs").said
    )
    rows = [
        replace(ROW, judged_as=judged_as, judgement=judgement, settled_rate_error_xyz_deg_s=errors)
        for judged_as, judgement, errors in (
            (verdicts.CURVE, verdicts.MISSES, [0.3, -0.4, 0.0]),
            (verdicts.CURVE, verdicts.MISSES, None),
            (verdicts.CURVE, verdicts.AGREES, [-0.1, 0.1, 0.2]),
            (verdicts.CURVE, verdicts.CANNOT, [8.0, 8.0, 8.0]),
            (verdicts.DISTRIBUTION, verdicts.AS_DISTRIBUTION, [7.0, 7.0, 7.0]),
        )
    ]
    fitted = replace(ROW, role="fitted", settled_rate_error_xyz_deg_s=[9.0, 9.0, 9.0])
    found = table(held_out=tuple(rows), compliant=(fitted, *rows[2:]))
    monkeypatch.setattr(constants.compare, "stored", lambda _: found)
    assert constants.margin(study, "springs").deg_s == pytest.approx(
        {"x": 0.3, "y": 0.4, "z": 0.2, "total": 0.5}
    )
    assert constants.margin(study, "springs").said == (
        "largest of 2 held-out conditions; not judged as curves: 2; not settled: 1"
    )
    assert constants.margin(study, "compliant").deg_s == pytest.approx(
        {"x": 0.1, "y": 0.1, "z": 0.2, "total": 0.06**0.5}
    )
    assert set(
        constants.margin(Study(free_flight.scene(), tmp_path, Settings()), "springs").deg_s.values()
    ) == {0.0}
