"""Deflection and natural frequencies of the rail, mesh by mesh. The settled rates depend on both.

The deflection is the mean displacement of the wall under a pad face by a force spread over it, at
the place along the way where the rail is softest on the finest mesh. At the edge of a rigid mount and
in a sharp inner corner the stress is singular, so both converge with about the first power of the
element size. With a fillet on joints nothing is singular, and the power is the second one on fine
elements.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from tipoff.scenes.scene import Scene

FORCE = 100.0  # N
MODES = 4
_PLACES = 41  # places along the way of the pads


def quantities(
    scene: Scene, sizes: Sequence[float]
) -> Iterator[tuple[str, str, Sequence[float | None]]]:
    """(quantity, unit, value in elements of each of the ``sizes``, m, coarsest first); empty
    without contact, because no pad presses. Raises MeshError."""
    if scene.contact is None:
        return
    from tipoff.highfi import compliance  # slow to load
    from tipoff.scenes import scene_model

    faces = scene_model.built(scene).nominal
    way = (scene.rail.end - faces.half_length - faces.centre[:, 0]).max()
    places = np.linspace(0.0, way, _PLACES)
    found = [compliance.along(scene, size, places, patterns=1, modes=MODES) for size in sizes]
    means = [np.einsum("sfafa->sf", item.matrix) for item in found]  # m/N
    softest = np.unravel_index(means[-1].argmax(), means[-1].shape)
    yield (
        f"deflection under {FORCE:g} N",
        "µm",
        [1e6 * FORCE * float(mean[softest]) for mean in means],
    )
    for mode in range(MODES):
        yield (
            f"natural frequency {mode + 1}",
            "Hz",
            [float(item.frequency[0, mode]) / (2.0 * np.pi) for item in found],
        )
