"""Random errors of a file, on a launch without contact, where the distribution of the rates is known."""

import math

import numpy as np
import pytest

from tests.studies import free_flight
from tests.studies.shown import html
from tipoff.studies.render.document import terminal
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study
from validation.montecarlo import cases, page
from validation.montecarlo import stage as montecarlo
from validation.montecarlo.options import Cases

SCALE = 0.2e-3  # m
FILE = f"""
cases = 7
seed = 5
sampling = "sobol"
[vary."thrust_offset.eccentricity.axial"]
distribution = "rayleigh"
scale = "{1e3 * SCALE} mm"
[vary."thrust_offset.eccentricity.radial"]
distribution = "uniform"
low = "0 deg"
high = "360 deg"
"""


@pytest.fixture(scope="module")
def options(tmp_path_factory):
    path = tmp_path_factory.mktemp("errors") / "errors.toml"
    path.write_text(FILE)
    return Cases(cases=1500, limits=("8 deg/s",), vary=str(path))


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return Study(free_flight.scene(), tmp_path_factory.mktemp("out"), Settings(workers=2))


@pytest.fixture(scope="module")
def found(study, options):
    return montecarlo.run(study, options).result


def test_the_rate_has_a_rayleigh_distribution(found):
    """Quantiles within their bounds, and the probability above the limit. The control: the errors of Table 3,
    the default, have others."""
    scale = free_flight.RATE_PER_METRE * SCALE
    total = next(item for item in found.quantities if item.name == "rate_deg_s")
    for quantile in total.quantiles:
        exact = scale * math.sqrt(-2.0 * math.log(1.0 - quantile.share))
        if quantile.low is not None and quantile.high is not None:
            assert 0.99 * quantile.low < exact < 1.01 * quantile.high
    (tail,) = found.tails
    assert tail.low < math.exp(-0.5 * (8.0 / scale) ** 2) < tail.high
    assert found.counts["asked"] == 1500 and "errors.toml (thrust_offset.ecc" in found.reading


def test_the_first_cases_do_not_depend_on_the_number(study, options):
    few, many = (cases.source(study.scene, options, count) for count in (20, 1000))
    assert few.rows(0, 20) == many.rows(0, 20)
    other = cases.source(study.scene, Cases(cases=20), 20).rows(0, 20)
    assert not np.isclose(
        [row["thrust_offset.eccentricity.axial"] for row in other],
        [row["thrust_offset.eccentricity.axial"] for row in few.rows(0, 20)],
    ).any()


def test_a_file_has_no_readings_on_the_page(found):
    assert found.readings == ()
    for shown in (html(page.draw(found)), terminal(page.summary(found))):
        assert "reading" not in shown and "errors.toml" in shown.replace("\n", "")


def test_another_content_of_the_file_is_another_result(study, options, tmp_path):
    changed = tmp_path / "errors.toml"
    changed.write_text(FILE.replace("0.2 mm", "0.3 mm"))
    before, after = (
        cases.inputs(study.scene, Cases(vary=path)) for path in (options.vary, str(changed))
    )
    assert before != after and cases.inputs(study.scene, Cases()) == {}
