"""Growth of a disturbance, on curves with a known rate of growth."""

import numpy as np
import pytest

from tests.studies.synthetic import flight
from tipoff import lowfi, scenes
from tipoff.studies.agreement.growth import contacts, growth, horizon

GATE = 0.1  # deg/s
RATE, START = 400.0, 1e-5  # 1/s, rad/s
TOUCHES = ((60, 100), (180, 220), (300, 340))  # samples, 0.05 ms apart


def touching(rate=None):
    """A flight whose rate about y is ``rate(t)``, with three contacts of 2 ms."""
    force = np.zeros((601, 16, 3))
    for begin, end in TOUCHES:
        force[begin:end, 0, 1] = 10.0
    return flight(rate and (lambda t: np.outer(rate(t), [0.0, 1.0, 0.0])), pad_force=force)


def test_exponential_growth_is_recovered():
    """s = s0 e^(l t): the horizon is ln(gate / s0) / l whatever lies between the samples, the
    exponent l times what the means over two free flights of different length leave of it, exactly l
    between the two of the same length."""
    found = growth("c", "m", touching(), [touching(lambda t: START * np.exp(RATE * t))], 1e-6, GATE)
    assert found.horizon_s == pytest.approx(np.log(GATE / np.degrees(START)) / RATE, rel=1e-5)
    assert [contact.start_s for contact in found.contacts] == pytest.approx(
        [begin * 5e-5 for begin, _ in TOUCHES], abs=1e-4
    )
    first, second, _ = found.contacts
    assert first.exponent_per_s is None and second.exponent_per_s == pytest.approx(RATE, rel=1e-3)
    assert second.factor == pytest.approx(np.exp(RATE * 6e-3), rel=1e-2)
    assert found.chaotic and found.settled_growth_deg_s_um == found.settled_separation_deg_s > GATE


def test_separation_of_two_curves_is_the_larger_twin_and_axis():
    found = growth(
        "c",
        "m",
        touching(),
        [touching(lambda t, value=value: np.full(t.size, value)) for value in (1e-4, -3e-4, 2e-4)],
        2e-6,
        GATE,
    )
    assert set(found.separation_deg_s) == {float(f"{np.degrees(3e-4):.4g}")}
    assert found.settled_growth_deg_s_um == pytest.approx(np.degrees(1.5e-4))


def test_control_that_does_not_grow_has_no_horizon():
    """The same disturbance kept at its size; and twins that never touch, which do not part at
    all."""
    found = growth("c", "m", touching(), [touching(lambda t: np.full(t.size, START))], 1e-6, GATE)
    assert found.horizon_s is None and found.chaotic is False
    assert found.factor == pytest.approx(1.0) and found.exponent_per_s == pytest.approx(
        0.0, abs=1e-9
    )
    free = growth("c", "m", flight(), [flight()], 1e-6, GATE)
    assert (
        free.contacts == []
        and free.horizon_s is None
        and free.chaotic is False
        and free.factor is None
    )


def test_one_hard_contact_is_sensitive_and_not_chaotic():
    """Three contacts of which the first does it all; control: the growth above ends no farther away
    and is chaotic."""
    found = growth(
        "c",
        "m",
        touching(),
        [touching(lambda t: np.where(t < 4e-3, 0.0, np.radians(2.0 * GATE)))],
        1e-6,
        GATE,
    )
    assert (
        found.sensitive
        and found.chaotic is False
        and found.horizon_s == pytest.approx(4e-3, abs=1e-4)
    )
    assert growth(
        "c", "m", touching(), [touching(lambda t: START * np.exp(RATE * t))], 1e-6, GATE
    ).chaotic


def test_shifted_contact_is_no_horizon():
    """A peak that the contact takes back is a contact that came late. Controls: one that stays
    passes the gate where it rose; one in free flight counts at once."""
    time, contact = np.linspace(0.0, 0.03, 601), [(190, 260)]
    peak = (np.arange(601) >= 200) & (np.arange(601) < 255)
    assert horizon(time, np.where(peak, 1.0, 0.0), contact, GATE) is None
    assert horizon(time, np.where(np.arange(601) >= 200, 1.0, 0.0), contact, GATE) == pytest.approx(
        10e-3
    )
    assert horizon(time, np.where(peak, 1.0, 0.0), [], GATE) == pytest.approx(10e-3)
    # never free again
    assert horizon(
        time, np.where(np.arange(601) >= 200, 1.0, 0.0), [(190, 601)], GATE
    ) == pytest.approx(10e-3)


def test_bounces_in_quick_succession_are_one_contact():
    time = np.arange(100) * 1e-4
    loaded = np.isin(np.arange(100), [*range(10, 20), *range(25, 30), *range(60, 65), 99])
    assert contacts(time, loaded) == [(10, 30), (60, 65), (99, 100)]


def test_run_that_did_not_settle_is_not_judged():
    lost = flight(status="time_limit")
    found = growth("c", "m", flight(), [lost], 1e-6, GATE)
    assert (
        found.settled_separation_deg_s is None and found.sensitive is None and found.chaotic is None
    )


@pytest.mark.parametrize(
    "condition, sensitive, chaotic",
    [("phi15", False, False), ("h7", True, False), ("h8", True, True)],
)
def test_verdicts_of_the_surrogate_on_the_reference(condition, sensitive, chaotic):
    """One light contact; hard ones that leave the separation about as the first made it; and four
    that amplify it in turn."""
    scene = scenes.load("reference").condition(condition)
    nominal, *twins = [
        lowfi.run(scene.replace({"contact.clearance": scene.contact.clearance + change}), "springs")
        for change in (0.0, 1e-6, -1e-6)
    ]
    found = growth(condition, "surrogate", nominal, twins, 1e-6, GATE)
    assert (found.sensitive, found.chaotic) == (sensitive, chaotic)
    assert (found.horizon_s is not None) == sensitive
