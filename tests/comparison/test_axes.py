"""Rates in scene axes become rates in body axes."""

import numpy as np

from tests.formats.curves.dyna_files import written
from tipoff.comparison.layout import of_options
from tipoff.comparison.quantities import in_body_axes, read_quantities

SPIN, PRECESSION = 3.0, 5.0  # rad/s


def precession(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates (n,3) rad/s in scene and in body axes of a body that spins about its x axis, while this
    axis turns about the z axis of the scene: Q = Rz(p t) Rx(s t)."""
    p, s = PRECESSION * time, SPIN * time
    scene = np.column_stack([SPIN * np.cos(p), SPIN * np.sin(p), np.full(time.size, PRECESSION)])
    body = np.column_stack(
        [np.full(time.size, SPIN), PRECESSION * np.sin(s), PRECESSION * np.cos(s)]
    )
    return scene, body


def largest_error(samples: int) -> float:
    time = np.linspace(0.0, 0.4, samples)
    scene, body = precession(time)
    return float(np.abs(in_body_axes(time, scene) - body).max())


def test_a_precession_has_its_exact_rates_to_second_order():
    """Turned by two radians. Control: rates in scene axes differ by as much as the rates are."""
    coarse, fine = largest_error(201), largest_error(401)
    assert fine < 1e-4 and 3.9 < coarse / fine < 4.1
    scene, body = precession(np.linspace(0.0, 0.4, 401))
    assert np.abs(scene - body).max() > 1.0


def test_a_table_states_its_axes(tmp_path):
    """Control: by default the rates of a table are in body axes, and stay."""
    time = np.linspace(0.0, 0.4, 401)
    scene, body = precession(time)
    lines = ["time [s],rate_x [rad/s],rate_y [rad/s],rate_z [rad/s]"]
    lines += [",".join(map(repr, row)) for row in np.column_stack([time, scene]).tolist()]
    path = written(tmp_path, "a.csv", "\n".join(lines))
    turned, kept = (
        read_quantities(path, of_options(["a"], axes=axes)["a"], optional=("velocity_x",)).values
        for axes in (["scene"], [])
    )
    for place, axis in enumerate("xyz"):
        np.testing.assert_allclose(turned[f"rate_{axis}"], body[:, place], atol=1e-4)
        np.testing.assert_allclose(kept[f"rate_{axis}"], scene[:, place], rtol=1e-12)
