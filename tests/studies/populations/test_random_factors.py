"""The paper's random factors: each reading against its closed form, and the linear tip-off from
draws to rates."""

import numpy as np
import pytest
from scipy import stats

from tests.studies import free_flight
from tipoff.faults import SceneError
from tipoff.lowfi.ensemble.rows import numbers
from tipoff.scenes import load
from tipoff.studies.populations import answers, population, random_factors, spread
from tipoff.studies.populations.random_factors import ERRORS, READINGS
from tipoff.studies.populations.reading import Reading
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

SCENE, COUNT = load("reference"), 20_000


def drawn(reading, cases=COUNT, seed=3):
    source = random_factors.source(SCENE, reading, cases, seed)
    return dict(zip(source.keys, numbers(source.keys, source.rows(0, cases)).T))


def plane(columns, name):
    """Signed parts (n,2) of an error, in units of its standard deviation."""
    error = ERRORS[name]
    size, angle = (
        columns[f"{error.key}.axial"] / (error.three_sigma / 3.0),
        columns[f"{error.key}.radial"],
    )
    return size * np.cos(angle), size * np.sin(angle)


@pytest.mark.parametrize(
    "reading, law",
    [
        (Reading(rule="none"), stats.halfnorm()),
        (Reading("half", rule="none"), stats.halfnorm()),
        (Reading("components", rule="none"), stats.rayleigh()),
        (Reading(), stats.truncnorm(0.0, 3.0)),
        (Reading(angles="shared", rule="none"), stats.halfnorm()),
    ],
)
def test_sizes_follow_the_law_of_their_reading(reading, law):
    """Control: the law of another reading is refused by the same test."""
    columns = drawn(reading)
    for error in ERRORS.values():
        sizes = columns[f"{error.key}.axial"] / (error.three_sigma / 3.0)
        assert stats.kstest(sizes, law.cdf).pvalue > 1e-3
        other = stats.halfnorm if reading.values == "components" else stats.rayleigh
        assert stats.kstest(sizes, other.cdf).pvalue < 1e-6


@pytest.mark.case("O48")
@pytest.mark.parametrize(
    "rule, variance, fourth",
    [("redraw", 0.9733369, 2.6795), ("clip", 0.9950073, 2.9), ("none", 1.0, 3.0)],
)
def test_variance_by_rule_of_truncation(rule, variance, fourth):
    """In units of sigma^2; the error of a variance is sqrt((m4 - m2^2)/n), ``fourth`` being m4 at
    most."""
    columns = drawn(Reading(rule=rule), 50_000)
    sizes = [columns[f"{error.key}.axial"] / (error.three_sigma / 3.0) for error in ERRORS.values()]
    assert abs(np.mean(np.square(sizes)) - variance) < 3.0 * np.sqrt(
        (fourth - variance**2) / (3 * 50_000)
    )


def test_one_angle_puts_both_eccentricities_on_one_line():
    """Signed errors add as often as they cancel; half-normal errors always add."""
    for reading, signs in (
        (Reading(angles="shared"), {-1.0, 1.0}),
        (Reading("half", "shared"), {1.0}),
    ):
        columns = drawn(reading, 500)
        (y, z), (other_y, other_z) = (
            plane(columns, "thrust_eccentricity"),
            plane(columns, "mass_eccentricity"),
        )
        cosine = (y * other_y + z * other_z) / np.hypot(y, z) / np.hypot(other_y, other_z)
        assert np.allclose(np.abs(cosine), 1.0) and set(np.sign(cosine)) == signs
    apart = drawn(Reading(), 500)
    assert (
        np.ptp(
            np.cos(
                apart["mass_offset.eccentricity.radial"]
                - apart["thrust_offset.eccentricity.radial"]
            )
        )
        > 1.9
    )


def test_a_case_has_the_same_bits_in_every_chunk_and_the_reading_is_part_of_the_identity():
    whole = {}
    for reading in READINGS:
        source = random_factors.source(SCENE, reading, 300, 5)
        whole[reading] = source.rows(0, 300)
        assert [
            row for begin in range(0, 300, 7) for row in source.rows(begin, min(begin + 7, 300))
        ] == whole[reading]
        assert all(
            row[f"{error.key}.axial"] >= 0.0 for row in whole[reading] for error in ERRORS.values()
        )
    identities = [
        str(random_factors.source(SCENE, reading, 300, 5).identity) for reading in READINGS
    ]
    assert len(set(identities)) == len(READINGS)
    inside = np.array(
        [
            [row["initial.position.y"], row["initial.position.z"]]
            for row in whole[Reading(initial=True)]
        ]
    )
    assert 0.9 * SCENE.contact.clearance < np.abs(inside).max() <= SCENE.contact.clearance


def test_the_initial_position_is_inside_the_clearance_of_each_axis():
    scene = SCENE.replace({"contact.clearance_z": 1e-4})
    source = random_factors.source(scene, Reading(initial=True), 300, 5)
    drawn = dict(zip(source.keys, numbers(source.keys, source.rows(0, 300)).T))
    for axis, gap in (("y", scene.contact.clearance), ("z", 1e-4)):
        assert 0.9 * gap < np.abs(drawn[f"initial.position.{axis}"]).max() <= gap


def test_the_interface_stiffness_is_known_to_a_factor():
    """Its logarithm is uniform from a quarter to four times the scene's value. Control: the number
    itself is not, and no other reading draws it."""
    key = "contact.interface_stiffness"
    factors = drawn(Reading(interface=True))[key] / SCENE.contact.interface_stiffness
    assert stats.kstest(np.log2(factors), stats.uniform(-2.0, 4.0).cdf).pvalue > 1e-3
    assert stats.kstest(factors, stats.uniform(0.25, 3.75).cdf).pvalue < 1e-6
    assert key not in drawn(Reading(), 10)


def test_contradicting_options_are_refused_with_every_fault():
    with pytest.raises(SceneError) as refused:
        random_factors.source(
            free_flight.scene(), Reading("components", "shared", "redraw", True, True), 100, 1
        )
    for option in ("--angles", "--initial", "--interface"):
        assert option in str(refused.value)


@pytest.mark.case("O47")
@pytest.mark.parametrize("cases", [3000, pytest.param(8000, marks=pytest.mark.slow)])
def test_linear_tip_off_on_a_launch_without_contact(tmp_path, cases):
    """sd of w_y: the half variances add up to 3.121965 deg/s. Control: components have twice the
    variance of one signed value."""
    scene = free_flight.scene()
    study, exact = Study(scene, tmp_path, Settings(workers=1)), 3.121965
    sds = [
        size / 3.0
        for size in (
            free_flight.RATE_PER_RADIAN * ERRORS["misalignment"].three_sigma,
            free_flight.RATE_PER_METRE * 0.6e-3,
            free_flight.RATE_PER_METRE * 0.4e-3,
        )
    ]
    assert np.sqrt(0.5 * np.square(sds).sum()) == pytest.approx(exact, abs=1e-6)
    model = population.surrogate(study)
    assert model.calibration is None and model.compliance is None
    for reading, expected in (
        (Reading(rule="none"), exact),
        (Reading("components", rule="none"), np.sqrt(2.0) * exact),
    ):
        found = population.run(
            study, "linear", model, random_factors.source(scene, reading, cases, 1)
        )
        assert found.settled.all()
        for quantity in answers.RATES[1:]:
            moments = spread.moments(quantity.of(found.results))
            assert (
                abs(moments.sd - expected) < 3.0 * moments.sd_error < 0.2
                and abs(moments.mean) < 3.0 * moments.mean_error
            )
