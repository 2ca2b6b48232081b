"""Launches of a scene that is too sensitive for a comparison of single runs."""

from collections.abc import Callable

import numpy as np

from tipoff import highfi, lowfi
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.scene import Scene


def both_models(
    scene: Scene,
    compliance: RailCompliance,
    element_size: float,
    values: Callable[..., np.ndarray],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The ``values`` (n,) of one run of the reference, in elements of ``element_size`` (m), and the
    lowest and highest ones (n,) of twelve neighbours of the surrogate within 1 µm of play."""
    numerics = lowfi.Numerics.of_many(1e-2, compliance.frequency.shape[1])
    near = []
    for change in np.random.default_rng(1).uniform(-1e-6, 1e-6, 12):
        moved = scene.replace(scene.contact.widened(change))
        run = lowfi.run(moved, "compliant", compliance=compliance, numerics=numerics)
        near.append(values(run))
    found = values(highfi.run(scene, highfi.Numerics(element_size=element_size)))
    return found, np.min(near, axis=0), np.max(near, axis=0)
