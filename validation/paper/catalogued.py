"""Errors of the catalogue's scene, for comparison with the searches. The ends of searches depend on the
last bits of a run; a scene does not."""

import numpy as np

from tipoff.scenes.scene import Scene
from validation.paper import inputs, misfit, solutions


class _Given(misfit.Launcher):
    """The launcher with one scene at all points of the unit cube."""

    def scene(self, shares: np.ndarray) -> Scene:
        return self.base


def errors(scene: Scene, tolerance: float) -> dict:
    """The name of ``scene``, its largest errors of the nine rates and of their deviations, and its
    largest rate on conditions 1 and 5, all in deg/s."""
    assert scene.contact is not None
    launcher = _Given(scene, tolerance)
    shares = inputs.shares(
        inputs.values(np.full(len(inputs.UNKNOWNS), 0.5)) | {"exponent": scene.contact.exponent}
    )
    rates, changed = launcher.rates(shares), launcher.changed(shares)
    return {
        "name": scene.name,
        "largest_error_deg_s": float(np.abs(misfit.nine(rates)).max()),
        "largest_negligible_deg_s": solutions.largest_negligible(rates),
        "largest_deviation_error_deg_s": solutions.largest_of_deviations(rates, changed),
    }
