"""X8: a block dragged slowly through a spring sticks and slips; with a law that only creeps it does
neither."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest

from tests.lowfi.contact.dragged import DYNAMIC, SPEED, STATIC, STIFFNESS, G

JUMP = 2.0 * (STATIC - DYNAMIC) * G / STIFFNESS
PERIOD = JUMP / SPEED + math.pi * math.sqrt(1.0 / STIFFNESS)


@pytest.mark.slow
@pytest.mark.case("X8")
def test_stick_slip(tmp_path):
    """Jump 2 (mu_s - mu_d) m g/k and period jump/v + pi sqrt(m/k) at two tolerances, friction
    passive, events few."""
    assert (JUMP, PERIOD) == pytest.approx((0.19613e-3, 1.9927), rel=1e-4)
    idle = tmp_path / "idle.csv"
    idle.write_text("time_s,force_N\n" + "\n".join(f"{2 * i},1e-12" for i in range(5)) + "\n")
    ran = subprocess.run(
        [sys.executable, "-m", "tests.lowfi.contact.dragged", str(idle)],
        capture_output=True,
        text=True,
        timeout=600,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)},
    )
    assert ran.returncode == 0, ran.stderr
    *sticking, smoothed = json.loads(ran.stdout).values()
    for found in sticking:
        assert found["status"] == "time_limit" and len(found["slips"]) == 3
        assert found["lengths"] == pytest.approx([JUMP] * 3, rel=0.03)
        assert np.diff(found["slips"]) == pytest.approx([PERIOD] * 2, rel=0.03)
        assert found["checks"]["friction_power_max"] <= 0.0 and found["least_rubbed"] >= 0.0
        assert (
            found["checks"]["energy_error"] <= 1e-6
            and found["checks"]["transverse_energy_error"] <= 1e-4
        )
        assert found["events"] <= 10 * len(found["slips"])
    # Control: with transition speeds of mm/s the block creeps along with the spring and never
    # slips.
    assert smoothed["status"] == "time_limit" and smoothed["slips"] == []
