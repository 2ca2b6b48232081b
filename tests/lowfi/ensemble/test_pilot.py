"""The pilot of an ensemble chooses its number of rail modes once: a store keeps it, and no case runs
without a number."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, handmade, reference_compliance
from tipoff.lowfi import Numerics, run_many
from tipoff.lowfi.ensemble import pilot
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Listed

WALLS = handmade(REFERENCE, {})
ROWS = [{"thrust_offset.misalignment.radial": 0.01 * number} for number in range(40)]


def asked(rows=ROWS, **numerics) -> Ensemble:
    return Ensemble(REFERENCE, Listed(rows), None, Numerics(**numerics), WALLS)


@pytest.fixture
def pilots(monkeypatch):
    """Pilot cases that need none, one, two modes and so on to 15; the list of their scenes."""
    seen: list = []

    def solved(scene, *_, **__):
        seen.append(scene)
        return SimpleNamespace(numerics={"modes": (len(seen) - 1) % pilot.PILOT})

    monkeypatch.setattr(pilot, "solved", solved)
    monkeypatch.setattr(pilot, "is_chaotic", lambda *_: False)
    return seen


def test_a_case_that_a_micrometre_turns_over_chooses_by_the_direct_effect(monkeypatch):
    """15 of 16 cases with a change of 0.6 of their total rate take the modes that change their contacts,
    whatever a run with modes would change. Control: a change of 0.4 leaves the choice to that run."""

    def pilot_of(share):
        def solved(scene, *_, **__):
            number = scene.thrust_offset.misalignment.radial
            base = REFERENCE.contact.clearance
            wider = share * (scene.contact.clearance - base) / 1e-6 * (number > 0.0)
            outcome = SimpleNamespace(rate=[0.0, 3e-3, 4e-3 + 5e-3 * wider])
            return SimpleNamespace(numerics={"modes": 20}, outcome=outcome)

        monkeypatch.setattr(pilot, "solved", solved)
        monkeypatch.setattr(pilot, "fewest_by_direct_effect", lambda *_: direct)
        return pilot.settled(asked())

    for direct in (0, 8):
        chaotic = pilot_of(0.6)
        assert chaotic.numerics.modes == direct and "15 are chaotic" in chaotic.modes_why
    regular = pilot_of(0.4)
    assert regular.numerics.modes == 20 and "clearance" not in regular.modes_why


def test_the_direct_effect_is_relative_to_the_rates(monkeypatch):
    """The effects of three modes are 0.3, 0.06 and 0.02 of the total rate: one mode is enough, as the
    others change it by less than a tenth."""
    rate = [0.0, 0.3, 0.4]
    run = SimpleNamespace(
        judged=lambda: ("exited", SimpleNamespace(rate=rate)),
        neglected=lambda: 0.5 * np.array([0.3, 0.06, 0.02]),
    )
    monkeypatch.setattr(pilot, "integrated", lambda *_: run)
    monkeypatch.setattr(pilot, "SingleRun", lambda *_, **__: None)
    assert pilot.fewest_by_direct_effect(asked(), REFERENCE, Numerics(modes=0)) == 1
    rate[1:] = [3.0, 4.0]
    assert pilot.fewest_by_direct_effect(asked(), REFERENCE, Numerics(modes=0)) == 0


def test_the_direct_effect_of_a_run():
    """The modes of the reference rail change a contact by less than a tenth of the rates. Control: a rail
    that is as stiff and a thousand times as heavy, whose modes are slow."""
    walls, plain = reference_compliance(), Numerics(modes=0)
    assert pilot.fewest_by_direct_effect(asked()._replace(compliance=walls), REFERENCE, plain) == 0
    heavy = replace(walls, frequency=walls.frequency / 30.0, shape=walls.shape / 30.0)
    assert pilot.fewest_by_direct_effect(asked()._replace(compliance=heavy), REFERENCE, plain) > 0


def test_a_store_keeps_the_number_and_its_reason(pilots, tmp_path):
    """16 pilot cases need 0 to 15 modes: 7 are enough for half of them. Control: without the store, or
    with that of other cases, the pilot runs again."""
    wanted = asked()
    first = pilot.settled(wanted, tmp_path / "store")
    assert len(pilots) == pilot.PILOT and first.numerics.modes == 7
    assert first.modes_why.startswith("7: enough for 8 of 16 pilot cases, ")
    first.store(tmp_path / "store")
    again = pilot.settled(wanted, tmp_path / "store")
    assert len(pilots) == pilot.PILOT and again == first
    assert again.key == first.key != wanted.key
    for other, path in (
        (asked(), tmp_path / "absent"),
        (asked(), None),
        (asked(ROWS[:-1]), tmp_path / "store"),
        (asked(relative_tolerance=1e-5), tmp_path / "store"),
    ):
        before = len(pilots)
        pilot.settled(other, path)
        assert len(pilots) == before + pilot.PILOT


def test_a_number_given_by_hand_is_no_choice(pilots, tmp_path):
    """A store made with the number 2 says nothing about what a pilot would choose."""
    by_hand = pilot.settled(asked(modes=2), tmp_path / "store")
    assert by_hand.numerics.modes == 2 and by_hand.modes_why == "" and not pilots
    by_hand.store(tmp_path / "store")
    assert pilot.settled(asked(), tmp_path / "store").numerics.modes == 7
    assert len(pilots) == pilot.PILOT


def test_a_store_whose_description_is_damaged_gives_no_number(pilots, tmp_path):
    pilot.settled(asked(), None).store(tmp_path / "store")
    described = tmp_path / "store" / "cases.zarr" / "zarr.json"
    described.write_text(described.read_text().replace('"7: enough', '"6: enough'))
    assert len(pilots) == pilot.PILOT
    assert pilot.settled(asked(), tmp_path / "store").modes_why.startswith("7: ")
    assert len(pilots) == 2 * pilot.PILOT


def test_models_without_modes_have_no_pilot(pilots):
    springs, free = asked()._replace(compliance=None), REFERENCE.replace({"contact": None})
    for ensemble in (springs, asked()._replace(scene=free, compliance=None)):
        found = pilot.settled(ensemble)
        assert found.numerics.modes == 0 and found.modes_why == ""
    assert not pilots


def test_no_case_runs_before_a_number_is_chosen():
    """Control: springs, and a number."""
    with pytest.raises(ValueError, match="modes: cases of an ensemble need a number"):
        Family(REFERENCE, None, Numerics(), WALLS)
    Family(REFERENCE, None, Numerics())
    Family(REFERENCE, None, replace(Numerics(), modes=0), WALLS)


def test_run_many_takes_the_number_of_its_store(tmp_path, monkeypatch):
    """The pilot of the second call would fail. Both have the same numbers."""
    numerics = Numerics(relative_tolerance=1e-2)
    options = {"compliance": WALLS, "numerics": numerics, "workers": 1}
    first = run_many(REFERENCE, ROWS[:3], **options, store=tmp_path / "store")
    monkeypatch.setattr(pilot, "solved", lambda *_, **__: pytest.fail("ran a pilot case again"))
    again = run_many(REFERENCE, ROWS[:3], **options, store=tmp_path / "store")
    assert again.identical(first) and again.attrs["modes_why"].startswith("none: ")
