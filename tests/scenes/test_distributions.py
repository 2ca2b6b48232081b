"""Distributions of uncertain numbers: moments against closed forms, the rules of truncation apart,
files that are wrong."""

import numpy as np
import pytest
from scipy import stats

from tipoff.faults import SceneError
from tipoff.scenes import load, uncertainty
from tipoff.scenes.distributions import BY_NAME, narrowed

KEY = "payload.mass"
MIDDLES = (np.arange(1_000_000) + 0.5) / 1_000_000  # quadrature of any function of a quantile


def table(name: str, **values):
    return BY_NAME[name].model_validate(
        {"distribution": name, **values}, context={"unit": "kg", "bare_numbers_are_si": True}
    )


@pytest.mark.parametrize(
    "drawn, exact",
    [
        (table("uniform", low=-1.0, high=3.0), stats.uniform(-1.0, 4.0)),
        (table("log-uniform", low=0.25, high=4.0), stats.loguniform(0.25, 4.0)),
        (table("normal", mean=2.0, sd=0.5), stats.norm(2.0, 0.5)),
        (
            table("truncated-normal", mean=2.0, sd=0.5, low=1.5, high=4.0, rule="redraw"),
            stats.truncnorm(-1.0, 4.0, 2.0, 0.5),
        ),
        (
            table("truncated-normal", mean=0.0, sd=1.0, low=7.0, high=9.0, rule="redraw"),
            stats.truncnorm(7.0, 9.0),
        ),
        (
            table("truncated-normal", mean=0.0, sd=1.0, low=-9.0, high=-7.0, rule="redraw"),
            stats.truncnorm(-9.0, -7.0),
        ),
        (table("rayleigh", scale=0.3), stats.rayleigh(0.0, 0.3)),
    ],
)
def test_quantiles_are_those_of_scipy(drawn, exact):
    u = np.concatenate([[2.0**-53, 1e-9], np.linspace(0.001, 0.999, 999), [1.0 - 1e-9]])
    assert np.allclose(drawn.ppf(u), exact.ppf(u), rtol=1e-9, atol=1e-12)


def test_fixed_is_the_value():
    assert (table("fixed", value=9.9).ppf(MIDDLES[:5]) == 9.9).all()


@pytest.mark.case("O48")
@pytest.mark.parametrize(
    "rule, variance, fourth", [("redraw", 0.9733369, 2.6795), ("clip", 0.9950073, 2.9)]
)
def test_variance_of_a_normal_limited_at_three_sigma(rule, variance, fourth):
    """By quadrature to the digits that are printed, and for draws within 3 standard errors.
    ``fourth``, at most, is the fourth moment."""
    limited = table("truncated-normal", mean=0.0, sd=1.0, low=-3.0, high=3.0, rule=rule)
    assert abs(limited.ppf(MIDDLES).var() - variance) < 2e-7
    count = 400_000
    found = limited.ppf(np.random.default_rng(5).random(count)).var()
    error = np.sqrt((fourth - variance**2) / count)
    assert abs(found - variance) < 3.0 * error
    other = {"redraw": 0.9950073, "clip": 0.9733369}[rule]
    assert abs(found - other) > 3.0 * error  # else the draws could not tell the rules apart


def test_every_number_depends_on_its_own_probability_alone():
    """Whatever stands beside it in the array: vector code treats ends of arrays in its own way."""
    u = np.random.default_rng(1).random(1001)
    for drawn in (
        table("normal", mean=0.1, sd=0.3),
        table("rayleigh", scale=0.3),
        table("uniform", low=0.1, high=0.7),
        table("log-uniform", low=0.1, high=0.7),
        table("truncated-normal", mean=0.1, sd=0.3, low=0.0, high=0.5, rule="redraw"),
    ):
        whole = drawn.ppf(u)
        assert all(drawn.ppf(u[n : n + 1])[0] == whole[n] for n in range(len(u)))
        assert np.array_equal(drawn.ppf(np.asfortranarray(np.stack([u, u], axis=1)).T[1]), whole)


def raw(**tables) -> dict:
    return {"cases": 10, "vary": tables}


def test_units_are_those_of_the_scene():
    found = uncertainty.parse(
        raw(
            **{
                "thrust_offset.misalignment.axial": {
                    "distribution": "normal",
                    "mean": "180 deg",
                    "sd": "1 deg",
                }
            }
        ),
        load("reference"),
    )
    assert found.vary["thrust_offset.misalignment.axial"].mean == pytest.approx(np.pi)
    nested = uncertainty.parse(
        raw(contact={"clearance": {"distribution": "fixed", "value": "0.2 mm"}}), load("reference")
    )
    assert nested.vary["contact.clearance"].value == pytest.approx(2e-4)


def test_every_fault_is_listed_at_once():
    tables = {
        "payload.mass": {"distribution": "normal", "mean": "9.9 m", "sd": "-1 kg"},
        "payload.weight": {"distribution": "fixed"},
        "contact.clearance": {"distribution": "gauss"},
        "friction.static": {"distribution": "uniform", "low": 0.3, "high": 0.2},
        "thrust.arm": {"distribution": "fixed", "value": 0.1},
        "contact.law": {"distribution": "fixed", "value": 1.0},
    }
    with pytest.raises(SceneError) as refused:
        uncertainty.parse(
            {"cases": 0, "sampling": "halton", "vary": tables}, load("reference"), "errors.toml"
        )
    text = str(refused.value)
    for words in (
        "errors.toml: cases",
        "sampling",
        "vary.payload.mass.mean",
        "vary.payload.mass.sd: given '-1 kg', expected greater than 0",
        "vary.payload.weight",
        "no such key",
        "vary.contact.clearance.distribution",
        "vary.friction.static.high",
        "vary.thrust.arm.value",
        "vary.contact.law",
        "a key that holds a number",
    ):
        assert words in text, words


def test_a_place_the_scene_does_not_have_is_found_before_any_run():
    with pytest.raises(SceneError, match="pads.8"):
        uncertainty.parse(
            raw(**{"pads.8.relief": {"distribution": "fixed", "value": "1 um"}}), load("reference")
        )
    with pytest.raises(SceneError, match="paper"):
        uncertainty.load("no_such_file", load("reference"))


def test_the_errors_of_a_scene_are_the_default():
    """Control: a scene without errors has those of the paper, and a given file replaces both."""
    own = load("cubesat_3u")
    assert uncertainty.chosen(None, own) == "cubesat_3u"
    assert uncertainty.chosen("paper", own) == "paper"
    assert uncertainty.chosen(None, own.replace({"studies": None})) == uncertainty.DEFAULT


@pytest.mark.parametrize(
    "drawn, middle",
    [
        (table("uniform", low=-1.0, high=3.0), 1.0),
        (table("normal", mean=2.0, sd=0.5), 2.0),
        (table("truncated-normal", mean=2.0, sd=0.5, low=1.5, high=4.0, rule="redraw"), 2.0),
        (table("truncated-normal", mean=2.0, sd=0.5, low=1.5, high=4.0, rule="clip"), 2.0),
        (table("rayleigh", scale=0.3), 0.0),
        (table("fixed", value=7.0), 7.0),
    ],
)
def test_a_narrowed_distribution_moves_each_draw_towards_its_middle(drawn, middle):
    """And towards another place that is given. The logarithm of a log-uniform number moves."""
    u = np.linspace(0.001, 0.999, 999)
    values = drawn.ppf(u)
    assert np.allclose(narrowed(drawn, 0.5).ppf(u), middle + 0.5 * (values - middle), rtol=1e-9)
    assert np.allclose(narrowed(drawn, 0.5, 0.0).ppf(u), 0.5 * values, rtol=1e-9, atol=1e-12)
    logarithmic = table("log-uniform", low=0.25, high=16.0)
    found = np.log(narrowed(logarithmic, 0.5).ppf(u))
    assert np.allclose(found, np.log(2.0) + 0.5 * (np.log(logarithmic.ppf(u)) - np.log(2.0)))
