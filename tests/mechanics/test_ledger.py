"""The two ledgers: zero when consistent, and the transverse one shows an error that the total one
cannot."""

import numpy as np

from tipoff.mechanics import ledger

COLUMN = {name: index for index, name in enumerate(ledger.ENTRIES)}
TIME = np.linspace(0.0, 1.0, 401)


def entries(**columns) -> np.ndarray:
    table = np.zeros((TIME.size, len(ledger.ENTRIES)))
    for name, values in columns.items():
        table[:, COLUMN[name]] = values
    return table


# 500 J of axial motion; beside it 1 mJ goes to and fro between bouncing and contact, a tenth of it
# lost on the way.
BOUNCE = 1e-3
LOST = 0.1 * BOUNCE * TIME
STORED = (BOUNCE - LOST) * np.sin(8.0 * TIME) ** 2
ACROSS = (BOUNCE - LOST) * np.cos(8.0 * TIME) ** 2
PUSH = 500.0 * TIME


def total(stored):
    return entries(
        thrust=PUSH,
        kinetic=PUSH + ACROSS,
        contact_stored=stored,
        contact_damping=0.5 * LOST,
        friction=0.3 * LOST,
        structural_damping=0.1 * LOST,
        released=0.1 * LOST,
    )


def transverse(stored):
    return entries(
        kinetic=ACROSS,
        contact_stored=stored,
        contact_damping=0.5 * LOST,
        friction=0.3 * LOST,
        structural_damping=0.1 * LOST,
        released=0.1 * LOST,
    )


def test_consistent_ledgers_close():
    assert ledger.total_error(total(STORED)) < 1e-15
    assert ledger.transverse_error(transverse(STORED)) < 1e-14


def test_one_per_cent_of_spurious_contact_energy_is_seen_only_across():
    """Total: 1e-5 J in 500 J is 2e-8, below its promise of 1e-6. Transverse: 1e-2, a hundred times
    its promise of 1e-4."""
    false = 1.01 * STORED
    assert ledger.total_error(total(false)) < 1e-6
    assert 5e-3 < ledger.transverse_error(transverse(false)) < 1.1e-2


def test_works_that_cancel_are_a_scale():
    """A thrust lifts a weight slowly: both works are 500 J, and 1e-4 J is their share of 1e-7. Control:
    an error of a thousandth is seen."""
    lifted = entries(thrust=PUSH, gravity=-PUSH + 1e-4 * TIME)
    assert ledger.total_error(lifted) < 1e-6
    lifted[:, COLUMN["gravity"]] *= 0.999
    assert ledger.total_error(lifted) > 1e-4


def test_every_entry_counts():
    for name in ledger.ENTRIES:
        wrong = transverse(STORED)
        wrong[1:, COLUMN[name]] += 0.01 * BOUNCE
        assert ledger.transverse_error(wrong) > 5e-3, name


def test_signs():
    """Work done on the bodies raises the residual, what they hold or lose lowers it; the start
    counts as given."""
    for name in ledger.ENTRIES:
        table = entries()
        table[1:, COLUMN[name]] = 1.0
        assert ledger.residual(table)[-1] == (1.0 if name in ("thrust", "gravity") else -1.0)
    assert (ledger.residual(entries(kinetic=3.0, strain=2.0, contact_stored=1.0)) == 0.0).all()


def test_nothing_moves():
    assert ledger.total_error(entries()) == 0.0
    assert ledger.transverse_error(entries()) == 0.0


def test_energy_from_nowhere_is_not_hidden_by_a_missing_scale():
    assert ledger.transverse_error(entries(friction=-1e-3 * TIME)) > 0.0
