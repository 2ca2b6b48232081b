"""Tolerances checked by the reference, on a launch without contact, where the probability of a rate
above its limit is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from tests.studies import free_flight
from tipoff.faults import SceneError
from tipoff.studies.limits import certificate, page, stage
from tipoff.studies.limits.certificate import Within
from tipoff.studies.limits.constants import Margin
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.limits.results import CertifiedFactor, Drawn, Limits
from tipoff.studies.limits.search import Found, Trial
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.populations.stratified import Runs
from tipoff.studies.render.document import terminal
from tipoff.workspace import store
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

LIMIT = Limit("total", 6.0)
TILT = math.radians(0.35)  # three sigma
OPTIONS = LimitsOptions(("6 deg/s",), probability=0.7, cases=200, certify=20)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    scene = free_flight.scene().replace(free_flight.BRIEF)
    settings = Settings(element_size=0.016, workers=1)
    return Study(scene, tmp_path_factory.mktemp("out"), settings)


def within(study, arm: float) -> Within:
    """Tolerance of misalignment; the thrust of the reference acts at ``arm`` times the distance."""
    scene = study.scene.replace({"thrust.arm": arm * free_flight.ARM})
    return Within(Surrogate(study.scene, None, None), scene, {"misalignment": TILT})


@pytest.fixture(scope="module")
def found(study):
    return certificate.made(study, OPTIONS, [LIMIT], 200, within(study, 1.0))


def truth(arm: float) -> float:
    """Probability that the tilt, normal and cut at three sigma, is above that of the limit."""
    sigmas = 3.0 * LIMIT.deg_s / (free_flight.RATE_PER_RADIAN * arm * TILT)
    return float(1.0 - stats.truncnorm(-3.0, 3.0).cdf(sigmas)) * 2.0


def test_both_models_agree_and_the_bound_is_above_the_closed_form(study, found):
    strata = {each.name: each for each in found.strata}
    assert found.cases == sum(each.cases for each in strata.values()) == 2000
    assert strata["near"].runs + strata["far"].runs == 20
    assert strata["near"].events == strata["far"].events == 0
    exact, share = truth(1.0), strata["above"].cases / 2000
    assert share == pytest.approx(exact, abs=4.0 * math.sqrt(exact / 2000))
    assert found.estimate == share and exact < found.upper < exact + 0.25
    assert found.certified and found.needed <= 20 and found.lost == ()
    said = shown(found)
    assert "20 runs at 1 times the set" in said and "not certified" not in said
    assert "at least 90% of a limit" in said


def shown(found: certificate.Certificate) -> str:
    """The text of a result with this certificate."""
    nominal = Found("found", 1.0, trials=(Trial(1.0, 40),))
    row = CertifiedFactor(
        name="together", words="set", unit="1", most=1.0, nominal=nominal, advised=None
    )
    made = Limits(
        **dict(model="", modes=0, modes_why="", agreement="", at="settled", at_why=""),
        **dict(asked=OPTIONS, limits=(LIMIT,), probability=0.7, confidence=0.95, cases=200),
        **dict(allowed=40, constants=Drawn(0, ()), margin=Margin(None, ""), rows=(row,)),
        **dict(map=None, certificate=found, evaluations=1),
    )
    return terminal(page.draw(made))


def test_a_reference_that_is_worse_is_seen(study, found):
    """The control: a third more arm puts every case near the limit above it."""
    worse = certificate.made(study, OPTIONS, [LIMIT], 200, within(study, 4.0 / 3.0))
    strata = {each.name: each for each in worse.strata}
    assert strata["near"].events == strata["near"].runs > 0
    assert worse.upper > max(found.upper, truth(4.0 / 3.0))
    assert worse.estimate > found.estimate and "not certified" in shown(worse)


def test_runs_are_kept(study, found, monkeypatch):
    monkeypatch.setattr(store, "execute", lambda *_, **__: pytest.fail("made again"))
    assert certificate.made(study, OPTIONS, [LIMIT], 200, within(study, 1.0)) == found


def test_strata_by_the_largest_ratio_to_a_limit():
    """A case that did not settle is above."""
    limits = [Limit("x", 2.0), Limit("total", 10.0)]
    rates = np.array([[1.7, 0, 0], [1.9, 0, 0], [2.1, 0, 0], [0, 9.5, 0], [0, 8, 7], [np.nan] * 3])
    above, near, far = (part.tolist() for part in certificate.strata(rates, limits))
    assert (above, near, far) == ([2, 4, 5], [1, 3], [0])


def test_number_of_runs_that_would_certify():
    """The bound of that number is small enough, that of nine tenths is not, and few runs near the
    limits do not stay few. None where too many cases of the surrogate are above."""
    options = LimitsOptions(probability=0.99)
    counts = (20, 100, 9880)
    runs = certificate.needed(counts, Runs(3, 0), Runs(100, 0), options)

    def upper(number: int) -> float:
        parts = certificate.stratified.allocated(counts, number, 0.95)
        near, far = (Runs(count, 0) for count in parts)
        return certificate.stratified.upper_bound(counts, near, far, 0.95).upper

    assert upper(runs) <= 0.01 < upper(9 * runs // 10)
    assert certificate.needed(counts, Runs(3, 1), Runs(100, 0), options) > runs
    assert certificate.needed((120, 10, 9870), Runs(10, 0), Runs(100, 0), options) is None


def test_too_few_runs_are_refused():
    with pytest.raises(SceneError, match="--certify.*19.*20 or more"):
        stage.checked(replace(OPTIONS, certify=19))
