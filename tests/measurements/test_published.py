"""What tipoff computes beside published measurements: the kept values are those of the code, and
agreement is stated as it is."""

import importlib
import re
import tomllib
from itertools import chain
from pathlib import Path

import pytest

from tests.measurements import aluminium_block, joints, oblique_impact

KEPT = tomllib.loads((Path(__file__).parent / "published.toml").read_text())
COMPUTED = KEPT["measurement"] + KEPT["input"]


def miss(measured: float, ours: float, within: str) -> float:
    """Difference over what ``within`` allows: "0.7 %", "0.8 deg" or "a factor of 4"."""
    if factor := re.fullmatch(r"a factor of ([\d.]+)", within):
        return max(ours / measured, measured / ours) / float(factor[1])
    limit, unit = within.split()
    return abs(ours - measured) / (float(limit) * (measured / 100.0 if unit == "%" else 1.0))


@pytest.mark.parametrize("kept", COMPUTED, ids=[item["id"] for item in COMPUTED])
def test_kept_values_are_those_of_the_code(kept):
    module = importlib.import_module(f"tests.measurements.{kept['computed_by']}")
    for series in kept["series"]:
        found = module.ours(series["at"])[series["quantity"]]
        assert series["ours"] == pytest.approx(found, rel=1e-3), series["quantity"]


@pytest.mark.parametrize("kept", KEPT["measurement"], ids=lambda kept: kept["id"])
def test_agreement_is_stated_as_it_is(kept):
    for series in kept["series"]:
        misses = [
            miss(measured, ours, series["within"])
            for measured, ours in zip(series["measured"], series["ours"], strict=True)
        ]
        assert (max(misses) <= 1.0) == series["agrees"], (kept["id"], series["quantity"], misses)


def test_a_miss_counts_in_both_directions():
    assert miss(2.0, 2.02, "1 %") == pytest.approx(1.0)
    assert miss(2.0, 1.5, "0.25 deg") == pytest.approx(2.0)
    assert miss(2.0, 1.0, "a factor of 4") == miss(1.0, 2.0, "a factor of 4") == 0.5


def test_modes_are_told_apart_by_their_mirror_images():
    """Control: frequencies of two meshes in ascending order, whatever their shapes, are
    extrapolated across modes that change places, and miss the measurement by more than it
    allows."""
    series = KEPT["measurement"][0]["series"][0]
    count = max(series["at"])
    found = count + aluminium_block.MORE  # as many as the kept values come from
    coarse, fine = (
        sorted(chain(*aluminium_block.on_mesh(size, found).values()))[:count]
        for size in (aluminium_block.COARSE, aluminium_block.FINE)
    )
    growth = (aluminium_block.FINE / aluminium_block.COARSE) ** 2 - 1.0
    mixed = [second + (second - first) / growth for first, second in zip(coarse, fine)]
    assert max(map(miss, series["measured"], mixed, [series["within"]] * count)) > 1.1


def test_a_ball_without_friction_keeps_its_tangential_speed():
    """Control: what the measured tangential restitution would be."""
    assert oblique_impact.rebound(49.694, friction=0.0)["tangential restitution"] == pytest.approx(
        1.0, rel=1e-9
    )


def test_stiffness_is_the_slope_of_the_measured_approach():
    """dp/dd of d = C p^m by a difference; the kept values are those of the middle of C and m."""
    pressure, step = 1e6, 1.0
    for c, m in ((0.65, 0.45), (0.3, 0.5)):
        low, high = (
            1e-6 * c * ((pressure + change) / joints.KGF_PER_CM2) ** m for change in (-step, step)
        )
        assert joints.measured(pressure, c, m) == pytest.approx(2.0 * step / (high - low), rel=1e-5)
    for series in KEPT["measurement"][3]["series"]:
        middle = [joints.measured(1e6 * p, 0.65, 0.45) / 1e12 for p in series["at"]]
        assert series["measured"] == pytest.approx(middle, rel=1e-3)
