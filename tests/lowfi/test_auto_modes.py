"""``modes="auto"``: on rails whose first frequencies span a factor of more than ten the surrogate
agrees with the reference on the same mesh, and no mode vibrates where none matters.

``python -m tests.lowfi.test_auto_modes`` prints the table of these rails in ``docs/rail_modes.md``.
"""

import functools
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.highfi.support import COARSE
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import highfi, lowfi
from tipoff.lowfi import Numerics, modes
from tipoff.lowfi.contact.compliant import neglected
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import load, scene_model

STEEL = {"density": 7850.0, "youngs_modulus": 210e9, "poisson_ratio": 0.3}
TITANIUM = {"density": 4430.0, "youngs_modulus": 113.8e9, "poisson_ratio": 0.342}


def mounts(*spans) -> list[dict]:
    """Spans (mm) along a rail."""
    return [{"start": 1e-3 * start, "end": 1e-3 * end} for start, end in spans]


def legs(thickness: float) -> dict:
    return {"rail.thickness": thickness, "rail.mount_width": thickness}


def of(material: dict) -> dict:
    return {f"rail.material.{key}": value for key, value in material.items()}


STRIP, THICK = "strip of steel, two mounts", "thick, many mounts"
TITANIUM_RAIL = "titanium, uneven mounts, a free end"
RAILS = {
    STRIP: of(STEEL) | legs(2e-3) | {"rail.mounts": mounts((8, 16), (160, 168))},
    TITANIUM_RAIL: of(TITANIUM) | {"rail.mounts": mounts((8, 24), (48, 64), (88, 96), (136, 144))},
    "tiny": {},
    THICK: legs(8e-3)
    | {"rail.mounts": mounts((0, 32), (48, 80), (96, 128), (144, 176), (192, 224))},
}


def scene(name: str, condition: str = "phi60"):
    return load("tiny").condition(condition).replace(RAILS[name])


@functools.cache
def compliance_of(name: str) -> RailCompliance:
    """On the mesh of the reference."""
    return highfi.condense(scene(name), COARSE.element_size)


def error(name: str, *numerics: Numerics) -> list[float]:
    """Largest errors of the settled rates (deg/s) on the mesh of the reference."""
    asked, compliance = scene(name), compliance_of(name)
    reference = highfi.run(asked, COARSE).outcome.rate
    return [
        apart(lowfi.run(asked, compliance=compliance, numerics=each).outcome.rate, reference)
        for each in numerics
    ]


def apart(rate, other) -> float:
    """Largest difference (deg/s) of two settled rates (3,) rad/s."""
    return float(np.degrees(np.abs(np.subtract(rate, other)).max()))


@pytest.mark.parametrize(
    "name", [TITANIUM_RAIL, pytest.param("tiny", marks=pytest.mark.slow), THICK]
)
def test_settled_rates_within_a_tenth_of_a_degree(name):
    (found,) = error(name, Numerics())
    assert found < 0.1


def test_a_soft_rail_needs_its_modes():
    """Control: without modes it is off by more than a tenth of a degree per second."""
    found, static = error(STRIP, Numerics(), Numerics(modes=0))
    assert found < 0.1 < static


def test_frequencies_of_the_rails_span_a_factor_of_ten():
    first = [compliance_of(name).frequency.min() for name in (STRIP, THICK)]
    assert first[1] > 10.0 * first[0]


def test_neglected_modes_move_the_rates_by_a_fiftieth_of_a_degree_at_most():
    """Fewest modes without which the others have at most 0.02 deg/s in sum: on both sides of it."""
    one, rest = np.radians([1.0]), np.radians([0.011, 0.0085, 0.0004])
    for others, count in ((rest, 1), (rest * 1.02, 2), (rest * [1.0, 0.0, 0.0], 1)):
        assert modes.needed(np.concatenate([one, others])) == count
    assert modes.needed(rest) == modes.needed(rest[:0]) == 0


@pytest.mark.parametrize("condition", ["phi0", "phi15", "phi35", "phi60", "phi90", "h1"])
def test_the_estimate_has_the_size_of_the_effect(condition):
    """Of all modes: magnitudes of contacts and modes are added, so it is above most effects.
    Control: without the contacts it is zero."""
    asked, compliance = REFERENCE.condition(condition), reference_compliance()
    watched = SingleRun(asked, Numerics(modes=0), compliance, watches=True)
    watched.begin()
    assert not watched.neglected().any()
    watched.integrate(None)
    static, every = (
        lowfi.run(asked, compliance=compliance, numerics=Numerics(modes=count)) for count in (0, 20)
    )
    effect = apart(every.outcome.rate, static.outcome.rate)
    assert 0.25 < effect / np.degrees(watched.neglected().sum()) < 2.0


def test_friction_drives_the_watched_modes_too(monkeypatch):
    """As if their shapes along X, times half its coefficient, were a part of those along the normals.
    Control: without them the estimate is another."""
    asked, compliance = REFERENCE.condition("phi35"), reference_compliance()

    def estimated(changed) -> np.ndarray:
        monkeypatch.setattr(neglected, "build", changed)
        watched = SingleRun(asked, Numerics(modes=0), compliance, watches=True)
        watched.begin()
        watched.integrate(None)
        return watched.neglected()

    plain = neglected.build

    def within(square, drag, shapes, along, friction):
        together = shapes.copy()
        together[..., : along.shape[-1]] += 0.5 * friction[0] * along
        return plain(square, drag, together)

    found = estimated(plain)
    assert found == pytest.approx(estimated(within), rel=1e-9)
    alone = estimated(lambda square, drag, shapes, *_: plain(square, drag, shapes))
    assert found.sum() != pytest.approx(alone.sum(), rel=1e-3)


CONDITIONS = ("phi0", "phi15", "phi35", "phi60", "phi90", "h1")


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, smallest, largest",
    [
        ("titanium", 0.3, 0.4),
        ("tiny", 0.3, 1.0),
        ("clamped", 0.2, 1.8),
        ("thin", 0.3, 1.8),
        ("reference", 0.2, 3.8),
    ],
)
def test_effect_of_all_modes_over_its_estimate(name, smallest, largest):
    """The table in docs/rail_modes.md."""
    scene = load(name)
    compliance = highfi.condense(scene, 8e-3)
    found = []
    for condition in CONDITIONS:
        asked = scene.condition(condition)
        watched = SingleRun(asked, Numerics(modes=0), compliance, watches=True)
        watched.begin()
        watched.integrate(None)
        static, every = (
            lowfi.run(asked, compliance=compliance, numerics=Numerics(modes=count)).outcome
            for count in (0, 20)
        )
        found.append(apart(every.rate, static.rate) / np.degrees(watched.neglected().sum()))
    assert [round(min(found), 1), round(max(found), 1)] == [smallest, largest]


def test_no_modes_where_none_matter():
    """The bits of a run without modes, and the reason."""
    asked, compliance = REFERENCE.condition("phi15"), reference_compliance()
    static, auto = (
        lowfi.run(asked, compliance=compliance, numerics=each)
        for each in (Numerics(modes=0), Numerics())
    )
    np.testing.assert_array_equal(auto.rate, static.rate)
    assert auto.numerics["modes"] == auto.cost["modes"] == 0
    assert auto.numerics["modes_why"].startswith("none: all 20 of each rail would move")
    assert auto.cost["steps"] == static.cost["steps"] and "auto_runs" not in auto.cost


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_a_coarse_integration_chooses_no_modes_that_the_contact_does_not_excite(tolerance):
    """The bits of a run without modes at this tolerance, after one run more, at the default tolerance.
    Control: from its own forces the coarse run would choose some."""
    asked, compliance = REFERENCE.condition("phi35"), reference_compliance()
    coarse = Numerics(relative_tolerance=tolerance, modes=0)
    auto, static, accurate = (
        lowfi.run(asked, compliance=compliance, numerics=each)
        for each in (replace(coarse, modes="auto"), coarse, Numerics(modes=0))
    )
    assert auto.numerics["modes"] == 0 and auto.numerics["modes_why"].startswith("none: all 20")
    np.testing.assert_array_equal(auto.rate, static.rate)
    assert auto.cost["steps"] == static.cost["steps"] < accurate.cost["steps"]
    assert (auto.cost["auto_runs"], auto.cost["auto_steps"]) == (1, accurate.cost["steps"])

    control = SingleRun(asked, coarse, compliance, watches=True)
    control.begin()
    control.integrate(None)
    assert modes.needed(control.neglected()) > 0


def test_a_coarse_run_that_needs_no_modes_is_not_repeated():
    found = lowfi.run(
        REFERENCE.condition("phi15"), compliance=reference_compliance(), numerics=Numerics(1e-2)
    )
    assert found.cost["modes"] == 0 and "auto_runs" not in found.cost


def test_a_coarse_run_has_the_modes_that_matter():
    """On a soft rail, at the tolerance that was asked for, to the last bit."""
    asked, numerics = scene(STRIP), Numerics(relative_tolerance=1e-3)
    compliance = compliance_of(STRIP)
    auto = lowfi.run(asked, compliance=compliance, numerics=numerics)
    count = auto.cost["modes"]
    hand = lowfi.run(asked, compliance=compliance, numerics=replace(numerics, modes=count))
    assert count > 0 and auto.cost["auto_runs"] >= 2
    np.testing.assert_array_equal(auto.rate, hand.rate)


def test_the_chosen_number_gives_the_bits_of_the_same_number_by_hand():
    asked = scene(STRIP)
    compliance = compliance_of(STRIP)
    auto = lowfi.run(asked, compliance=compliance)
    count = auto.numerics["modes"]
    hand = lowfi.run(asked, compliance=compliance, numerics=Numerics(modes=count))
    assert 0 < count == auto.cost["modes"] and auto.cost["auto_runs"] >= 1
    assert f"{count} of 20 of each rail" in auto.numerics["modes_why"]
    np.testing.assert_array_equal(auto.rate, hand.rate)


def test_the_runs_of_a_choice_share_the_records_of_their_scene(monkeypatch):
    """Control: another call makes its own."""
    made, build = [], scene_model.build
    monkeypatch.setattr(scene_model, "build", lambda scene: made.append(scene) or build(scene))
    asked, compliance = scene(STRIP), compliance_of(STRIP)
    for calls in (1, 2):
        assert lowfi.run(asked, compliance=compliance).cost["auto_runs"] >= 1
        assert len(made) == calls


def test_a_compliance_without_modes_says_so():
    compliance = reference_compliance()
    bare = replace(
        compliance, frequency=compliance.frequency[:, :0], shape=compliance.shape[..., :0]
    )
    found = lowfi.run(REFERENCE.condition("phi15"), compliance=bare)
    assert found.numerics["modes_why"] == "none: this rail compliance holds no modes"


def test_where_a_run_with_modes_fails_the_one_before_is_the_result():
    """Control: modes that matter, in a run that goes through."""
    for message in ("too many steps", ""):
        runs = [
            SimpleNamespace(
                modes=count,
                message=message if count else "",
                neglected=lambda count=count: np.where(np.arange(20) < count, 0.0, 1.0),
                judged=lambda: ("exited", SimpleNamespace(rate=[0.0, 0.0, 0.0])),
            )
            for count in range(21)
        ]
        found, choice = modes.choose(runs.__getitem__)
        assert found.modes == choice.modes == (0 if message else 20)
        assert (f"failed: {message}" in choice.why) is bool(message)
        assert len(choice.runs) == 1


def settled(count: int, effect: float, message: str = "", rate: float = 0.0):
    """A run with ``count`` of 20 modes that neglects modes of the ``effect`` (rad/s) each."""
    return SimpleNamespace(
        modes=count,
        message=message,
        neglected=lambda: np.where(np.arange(20) < count, 0.0, effect),
        judged=lambda: ("exited", SimpleNamespace(rate=[rate, 0.0, 0.0])),
    )


@pytest.mark.parametrize(
    ("accurate", "expected"),
    [(settled(0, 0.0), 0), (settled(0, 1.0, rate=0.3), 20), (settled(0, 0.0, "failed"), 20)],
)
def test_the_accurate_run_decides_unless_it_fails(accurate, expected):
    """Whatever the coarse one would choose: here all modes. Its change of the rates counts, not that
    of the coarse run. A failed run counts in the cost alone."""
    coarse = {count: settled(count, 1.0, rate=0.3 if count else 9.0) for count in range(21)}
    found, choice = modes.choose(coarse.__getitem__, lambda: accurate)
    assert found is coarse[expected] and choice.modes == expected
    assert accurate in choice.runs and len(choice.runs) == (1 if expected == 0 else 2)
    if not accurate.message and expected:
        assert "they moved them by 0 deg/s" in choice.why


def runs_that_move(*rates: float) -> tuple[list[int], Callable[[int], SimpleNamespace]]:
    """Numbers of modes of the runs made, and the maker of runs that settle at each of the ``rates``
    (deg/s) in turn. Only the one without modes has effects: 0.05 deg/s of four modes, 0.016 of the
    others."""
    made: list[int] = []

    def run(count: int) -> SimpleNamespace:
        made.append(count)
        found = settled(count, 0.0, rate=np.radians(rates[len(made) - 1]))
        found.neglected = (
            (lambda: np.radians([0.04, 0.01, 0.0, 0.0, 0.01, 0.005, 0.001]))
            if count == 0
            else pytest.fail
        )
        return found

    return made, run


@pytest.mark.parametrize(
    ("rates", "expected"),
    [
        ((0.0, 0.05), [0, 4]),
        ((0.0, 0.06), [0, 4]),  # the rest may be 1.2 times larger
        ((0.0, 0.10, 0.10), [0, 4, 7]),  # twice: all
        ((0.0, 9.00, 9.00), [0, 4, 7]),
    ],
)
def test_the_change_of_the_rates_shows_whether_more_modes_matter(rates, expected):
    """The effects are those of the run without modes: on a vibrating rail a contact breaks up into
    touches, for which the estimate is far too high."""
    made, run = runs_that_move(*rates)
    found, choice = modes.choose(run)
    assert made == expected
    assert found.modes == choice.modes == expected[-1] and len(choice.runs) == len(made) - 1


def test_an_ensemble_has_one_number_of_modes():
    """That of its pilot cases; each case has the bits of a single run with it."""
    asked = scene(STRIP)
    compliance = compliance_of(STRIP)
    rows = [{"payload.mass": mass} for mass in (9.8, 10.0)]
    found = lowfi.run_many(asked, rows, compliance=compliance, workers=1)
    count = found.attrs["modes"]
    assert count > 0 and "of 2 pilot cases" in found.attrs["modes_why"]
    numerics = Numerics(modes=count)
    single = [
        lowfi.run(asked.replace(row), compliance=compliance, numerics=numerics).outcome.rate
        for row in rows
    ]
    np.testing.assert_array_equal(found["rate"].values, single)


def _row(name: str, condition: str) -> tuple[str, ...]:
    """A row of the table of rails: errors without modes, with 20 and with the chosen ones, and the effect
    of all modes as estimated and as measured, deg/s."""
    asked, compliance = scene(name, condition), compliance_of(name)
    reference = highfi.run(asked, COARSE).outcome.rate
    none, every, auto = (
        lowfi.run(asked, compliance=compliance, numerics=each)
        for each in (Numerics(modes=0), Numerics(modes=20), Numerics())
    )
    watched = SingleRun(asked, Numerics(modes=0), compliance, watches=True)
    watched.begin()
    watched.integrate(None)
    errors = [f"{apart(run.outcome.rate, reference):.3f}" for run in (none, every, auto)]
    chosen = f"{errors[2]}, {auto.numerics['modes'] or 'none'}"
    estimated = f"{np.degrees(watched.neglected().sum()):.2g}"
    measured = f"{apart(every.outcome.rate, none.outcome.rate):.2g}"
    first = f"{compliance.frequency.min() / (2e3 * np.pi):.2g} kHz"
    return (name, first, condition, *errors[:2], chosen, estimated, measured)


if __name__ == "__main__":
    for rail in RAILS:
        for given in ("phi15", "phi60"):
            print("|", " | ".join(_row(rail, given)), "|", flush=True)
