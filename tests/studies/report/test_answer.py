"""The first screen of the page: what it says of known rows."""

import re
from dataclasses import asdict, replace

import numpy as np
import pytest

from tests.studies.agreement import made
from tests.studies.agreement.made import ROW
from tests.studies.convergence import stub
from tests.studies.shown import Documents, html
from tests.studies.synthetic import COSTS, flight
from tipoff import scenes
from tipoff.results.model_error import Range
from tipoff.scenes import drawing
from tipoff.studies.agreement import verdicts
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.render.table import Table
from tipoff.studies.report import answer
from tipoff.studies.report.page import Page
from tipoff.studies.runs.figures import Runs
from tipoff.studies.runs.results import AtExit
from tipoff.studies.runs.stage import row


def settled(x, y, z):
    rate = [float(np.radians(value)) for value in (x, y, z)]
    outcome = flight().outcome._replace(rate=rate, velocity=[13.6457, 0.0, 0.0])
    return flight(outcome=outcome, cost=COSTS)


def judged(name, uncertainty, **others):
    return replace(
        ROW,
        condition=name,
        reference_uncertainty_deg_s=uncertainty,
        settled_rate_error_deg_s=0.0312,
        floor_deg_s=0.043,
        **others,
    )


@pytest.fixture
def page(tmp_path):
    rows = [
        row("phi15", settled(-28.458, 3.0, 4.0), ""),
        row("phi60", settled(1.0, 0.3, 0.4), ""),
    ]
    lost = judged("phi15", 13.2, reference_converged=False, judgement=verdicts.CANNOT)
    agreement = made.document(compliant=(lost, judged("phi60", 7.64e-11)))
    return Page(
        scenes.load("tiny"),
        tmp_path,
        Documents(
            highfi={"conditions": list(map(asdict, rows)), "failed": []}, agreement=agreement
        ),
        Runs({}, {}, {}),
        {},
        [Limit("x", 6.0), Limit("total", 50.0)],
    )


def test_numbers_are_rounded_to_their_uncertainty(page):
    shown = html(answer.draw(page))
    assert "-28 ± 13" in shown and "-28.458" not in shown
    assert "1.000 ± &lt;0.001" in shown and "e-11" not in shown
    assert "28 ± 13" in shown and "largest roll rate (deg/s): phi15" in shown
    assert "5 ± 13" in shown  # across: 3 and 4


def test_limits_that_the_user_gave(page):
    shown = html(answer.draw(page))
    assert "<b>fail</b>" in shown and "above or not settled: phi15" in shown
    assert "✗\u00a0x" in shown and "✓ pass" in shown
    page.limits = [Limit("total", 50.0)]
    assert "<b>pass</b>" in html(answer.draw(page))
    page.limits = []
    assert "<b>pass</b>" not in html(answer.draw(page))


def test_limits_are_judged_at_the_exit_where_a_motor_burns_on(page):
    """As in ensembles. Control: 0.5 % of the impulse after the exit, and a condition without values
    there."""
    rows = page.results["highfi"]["conditions"]
    for one in rows:
        exit_ = {"velocity_m_s": [1.0, 0.0, 0.0], "rate_deg_s": [2.0, 0.0, 0.0]}
        one |= {"impulse_after_exit": 0.7, "at_exit": exit_}
    shown = html(answer.draw(page))
    assert "<b>pass</b>" in shown and "limits at the exit: " in shown
    rows[1]["at_exit"] = None
    assert "above or without a rate there: phi60" in html(answer.draw(page))
    for one in rows:
        one["impulse_after_exit"] = 0.005
    shown = html(answer.draw(page))
    assert "above or not settled: phi15" in shown and "at the exit: " not in shown


def test_limits_are_judged_by_the_range_that_replaces_a_value(page):
    """A neighbour of phi60 is above the limit, its own rate is not."""
    rates = [[1.0, 0.3, 0.4], [7.0, 0.3, 0.4]]
    page.results["agreement"]["distributions"] = [_neighbours(rates)]
    assert "above or not settled: all 2 conditions" in html(answer.draw(page))


def test_agreement_speed_and_trust(page):
    shown = html(answer.draw(page))
    assert "<b>1 of 2</b><span>conditions agree, 1 cannot be judged, 0 miss: surr" in shown
    assert "183 ×" in shown and "not at equal accuracy" in shown
    assert "Numerics: " in shown and "not converged on phi15" in shown
    assert "Model: " in shown and "within 0.031 deg/s" in shown
    assert "validated on a measured ejection" in shown
    assert re.search(r"Inputs: \d+ of \d+ values are assumed", shown)
    equal = replace(made.EQUAL, surer=False, element_size_m=4e-3)
    page.results["convergence"] = stub.document(equal=equal)
    assert "at least, at equal accuracy (mesh of 4 mm)" in html(answer.draw(page))
    del page.results["agreement"]
    assert "Model: surrogate and finite elements were not compared" in html(answer.draw(page))


def test_conditions_judged_as_distributions_are_said_apart(page):
    rows = page.results["agreement"]["compliant"]
    rows[0] |= {"judged_as": verdicts.DISTRIBUTION, "judgement": verdicts.MISSES}
    shown = html(answer.draw(page))
    assert "<b>1 of 2</b><span>conditions agree, 0 cannot be judged, 1 misses: surr" in shown
    assert "as distributions 0 of 1 conditions agree" in shown


def test_a_condition_is_stated_in_its_row(page):
    assert answer.stated(page, "phi60") == "misalignment radial 60 deg"
    assert answer.stated(page, "nominal") == "the scene itself"


def test_stated_changes_name_their_owner_and_have_four_digits(page):
    page.scene = scenes.load("reference")
    assert answer.stated(page, "h9") == (
        "misalignment axial 0.2667 deg, radial 70 deg; thrust eccentricity axial 0.4 mm, radial 160 "
        "deg; mass eccentricity axial 0.2667 mm, radial 310 deg"
    )
    assert answer.stated(page, "h6").startswith("no thrust offset; mass eccentricity axial 0.2 mm")
    assert answer.stated(page, "h10").endswith("position y 20 µm")


def test_rates_by_hand_stand_beside_those_of_the_run(page):
    assert "by hand" not in html(answer.draw(page))
    rows = page.results["highfi"]["conditions"]
    rows[1] |= {"by_hand": {"rate_deg_s": [1.0004, 0.3, 0.4], "words": "no pad touches"}}
    shown = html(answer.draw(page))
    assert "by hand: roll, transverse (deg/s)" in shown and "1.000, 0.500" in shown
    assert "moment impulse of the thrust over the inertia" in shown
    exit_ = {"velocity_m_s": [1.0, 0.0, 0.0], "rate_deg_s": [2.0, 0.0, 0.0]}
    pin = {"by_hand_at_exit": {"rate_deg_s": [0.0, 3.0, 4.0], "words": "a rigid rocket"}}
    rows[1] |= {"impulse_after_exit": 0.7, "at_exit": exit_, **pin}
    at_exit = html(answer.draw(page))
    assert "0.000, 5.000" in at_exit and "1.000, 0.500" not in at_exit


def test_the_largest_rate_of_converged_conditions_is_said_where_another_is_larger(page):
    shown = html(answer.draw(page))
    assert "phi15, not converged; of the converged ones 1.000 ± &lt;0.001 (phi60)" in shown
    page.results["convergence"] = stub.document(speed=2e-3)
    assert "v_x (m/s), each ± 0.002 by mesh and step, measured on phi60" in html(answer.draw(page))


@pytest.mark.parametrize("name", ["reference", "channel"])
def test_the_drawing_has_the_launcher_to_scale_with_both_clock_angles(name):
    scene = scenes.load(name)
    shown = str(drawing.launcher(scene))
    for words in (
        "from +Y towards +Z",
        "from +Z towards +Y",
        "thrust",
        "open end",
        "X towards you",
    ):
        assert words in shown
    widths = [float(width) for width in re.findall(r'class="payload"[^>]* width="([\d.]+)"', shown)]
    rails = [float(width) for width in re.findall(r'class="rail"[^>]* width="([\d.]+)"', shown)]
    length = scene.payload.size[0] if scene.payload.size else None
    if length:
        assert rails[0] / widths[0] == pytest.approx(
            (scene.rail.end - scene.rail.start) / length, rel=2e-3
        )
    mounts = len(getattr(scene.rail, "mounts", ()))
    assert shown.count('class="mount"') == 2 * mounts
    assert shown.count("<svg") == shown.count("</svg>") == 2


def test_assumptions_stand_first_in_the_appendix():
    from tipoff.studies.report import inputs

    table = inputs.scene_tables(scenes.load("reference"))[0]
    doubtful = [row[2].startswith(("assumed", "inferred", "not stated")) for row in table.rows]
    assert doubtful == sorted(doubtful, reverse=True) and True in doubtful and False in doubtful


def test_a_spread_condition_has_its_range_over_neighbours(page):
    """The value with an uncertainty as large as itself is left out. Control: without the neighbours it
    stands there."""
    assert "-28 ± 13" in html(answer.draw(page))
    rates = [[-31.0, 3.0, 4.0], [-12.0, 0.0, 2.0], [-25.0, 6.0, 8.0]]
    page.results["agreement"]["distributions"] = [
        {
            "condition": "phi15",
            "neighbours": 4,
            "further": 32,
            "limit_deg_s": 0.1,
            "reference_deg_s": [*rates, None],  # one that did not settle has no rate
            "models": {},
        }
    ]
    shown = html(answer.draw(page))
    assert "± 13" not in shown and "-31.0 to -12.0" in shown and "2.00 to 10.00" in shown
    assert "<b>12.0 to 31.0</b><span>largest roll rate (deg/s): phi15, over 3 neighbours" in shown
    assert "moved by less than 1 µm" in shown


def _sensitive(at_exit=False):
    """The row of a run on compliant contact, whose two neighbours roll by 5 and 9 deg/s."""
    own = Range(
        low_deg_s=(5.0, 3.0, 4.0),
        high_deg_s=(9.0, 6.0, 8.0),
        low_m_s=(13.5, -0.1, 0.0),
        high_m_s=(13.7, 0.1, 0.2),
        off_axis_deg=(0.1, 0.9),
        across_m_s=(0.0, 0.2),
        runs=2,
        lost=8,
        rates_deg_s=((5.0, 3.0, 4.0), (9.0, 6.0, 8.0)),
    )
    one = replace(row("phi60", settled(1.0, 0.3, 0.4), ""), range=own)
    exit_ = AtExit(velocity_m_s=(1.0, 0.0, 0.0), rate_deg_s=(2.0, 0.0, 0.0))
    return replace(one, impulse_after_exit=0.7, at_exit=exit_) if at_exit else one


def test_a_sensitive_run_has_ranges_in_all_its_cells(page):
    """Velocity, rates and direction, and the limits are judged by them. Control: the same rows without the
    range have values, and the comparison's neighbours by finite elements come before those of the surrogate."""
    alone = html(answer.draw(page))
    assert (
        "13.6457" in alone and "above or not settled: phi15" in alone and "A range in" not in alone
    )
    page.results["lowfi"] = {"conditions": [asdict(_sensitive())], "failed": []}
    shown = html(answer.draw(page))
    for words in ("13.500 to 13.700", "5.00 to 9.00", "5.0 to 10.0", "0.100 to 0.900"):
        assert words in shown and words not in alone
    assert "1.000 ± " not in shown and "A range in place of a value" in shown
    assert "above or not settled: all 2 conditions" in shown  # 9 deg/s are above 6
    assert "largest angle off axis (deg): phi60" in shown
    page.results["agreement"]["distributions"] = [_neighbours([[1.0, 0.0, 2.0], [1.5, 0.0, 2.5]])]
    both = html(answer.draw(page))
    assert "1.00 to 1.50" in both and "5.00 to 9.00" not in both and "13.500 to 13.700" in both


def test_a_sensitive_run_under_thrust_has_its_ranges_at_the_exit(page):
    """There are no neighbours for the settled values, which no number stands for."""
    own = _sensitive(at_exit=True)
    for name in ("highfi", "lowfi"):
        page.results[name] = {"conditions": [asdict(own)], "failed": []}
    (table,) = (part for part in answer.draw(page) if isinstance(part, Table))
    cells = dict(zip(table.heads, table.rows[0]))
    assert cells["at exit: roll, transverse (deg/s)"] == "5.00 to 9.00, 5.0 to 10.0"
    assert cells["roll rate (deg/s)"] is cells["transverse rate (deg/s)"] is None
    assert cells["off axis (deg)"] is None and "x" in cells["limits at the exit"]


def _neighbours(rates):
    return {
        "condition": "phi60",
        "neighbours": len(rates),
        "further": 16,
        "limit_deg_s": 0.1,
        "reference_deg_s": rates,
        "models": {},
    }


def test_the_scene_itself_comes_first(page):
    """Control: without its result the page begins with the conditions."""
    assert html(answer.draw(page)).startswith('<div class="figures"><div><b>13.6457</b>')
    rates = {"rate_deg_s": 5.0, "rate_x_deg_s": 0.0, "rate_y_deg_s": 3.0, "rate_z_deg_s": 4.0}
    values = rates | {"velocity_x_m_s": 13.6457, "exit_time_ms": 19.1}
    page.results["nominal"] = {
        "rows": [],
        "at": "settled",
        "at_why": "because no impulse after the exit is known",
        "answer": {"finite-elements": values, "compliant": values},
        "spread": None,
        "failed": [],
    }
    shown = html(answer.draw(page))
    assert shown.startswith('<div class="figures"><div><b>5.000 deg/s</b><span>total rate</span>')
    assert shown.index("no range is known") < shown.index("Over all conditions")
    assert shown.index("Over all conditions") < shown.index("largest roll rate")
