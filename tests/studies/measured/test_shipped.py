"""The logs that come with the package: made again bit for bit, labelled as simulated, and analysed
to what was put in."""

import numpy as np
import pytest

from tests.studies.measured import shipped
from tipoff.studies.measured.analysis import analyse
from tipoff.studies.measured.sheet import SAMPLES

# What the makers of the logs know and the analysis is not told (deg/s; s of the log).
TRUE = ([7.074, 1.7915, 9.185], [-0.067, 0.598, -1.036], [0.125, 0.156, 4.426])
RELEASE, IGNITION = 1.25, 1.65


@pytest.mark.parametrize("number", range(shipped.COUNT))
def test_a_log_is_made_again_bit_for_bit(number):
    """And its true change is the one the analysis is held against."""
    table, sheet, motion = shipped.make(number)
    path = SAMPLES[number]
    assert path.read_text() == sheet and path.with_suffix(".csv").read_text() == table
    assert np.degrees(motion.change) == pytest.approx(TRUE[number], abs=5e-4)
    assert (motion.release, motion.ignition) == (RELEASE, IGNITION)


@pytest.mark.parametrize("number", range(shipped.COUNT))
def test_a_log_says_that_it_is_simulated_and_gives_its_truth_back(number):
    path = SAMPLES[number]
    assert all(
        file.read_text().startswith("# SIMULATED, not measured")
        for file in (path, path.with_suffix(".csv"))
    )
    assert path.with_suffix(".csv").stat().st_size < 100_000
    found = analyse(path)
    assert found.sheet.simulated and "SIMULATED" in found.sheet.description
    assert found.events.release == pytest.approx(
        RELEASE, abs=2e-3
    ) and found.events.ignition == pytest.approx(IGNITION, abs=2e-3)
    error = np.abs(np.degrees(found.reduced.change) - TRUE[number])
    assert (error < np.degrees(found.reduced.factor * found.reduced.combined)).all()
    assert np.degrees(found.reduced.combined).max() < 0.05
    assert any("samples clipped at the range of 400 m/s2" in note for note in found.notes)


def test_truth_is_kept_from_the_analysis():
    """No number of the truth stands in a sheet or in the code that reads it."""
    folder = SAMPLES[0].parent.parent
    texts = [path.read_text() for path in (*SAMPLES, *folder.glob("*.py"))]
    assert not any(
        f"{abs(value):.3f}" in text for text in texts for values in TRUE for value in values
    )
