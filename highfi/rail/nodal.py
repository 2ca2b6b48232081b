"""Displacements of the nodes under the pads of a long rail (``mechanics.rail_compliance.nodal``)."""

import numpy as np

from tipoff.highfi.rail.places import Patches, reported
from tipoff.highfi.statics import thermal
from tipoff.highfi.statics.chain import Chain
from tipoff.highfi.statics.held import HeldRail
from tipoff.highfi.statics.solve import one_thread
from tipoff.mechanics.rail_compliance.nodal import Nodal, spanned

LEAST_BYTES = 1e7  # of the table between faces; a smaller one is stored as it is


def under_patches(
    held: HeldRail,
    patches: Patches,
    places: list[np.ndarray],
    inverses: tuple[np.ndarray, np.ndarray],
    middle: float,
    modes: int,
) -> tuple[Nodal, np.ndarray] | None:
    """Nodes of the only rail ``held`` under the ``patches``, with ``places`` (s,f) under the faces of
    each of its images, and the frequencies (n,) rad/s of its ``modes``. ``inverses`` (s,f,p,p) turn mean
    displacements into patterns, for all and for those that friction drags; X = ``middle`` (m) is that of
    thermal fields. None if tables between faces are smaller, or the rail is no chain."""
    number, patterns = np.max(places, axis=0), inverses[0].shape[-1]
    beside = max((each >= 0).any(axis=0).sum() for each in places)
    if number.min() < 0 or 8.0 * number.size * beside * patterns**2 < LEAST_BYTES:
        return None
    clamped = held.clamped(len(patches.found) * patterns)
    if clamped.chain is None:
        return None
    grouped = patches.by_lines(clamped.free, clamped.chain)
    if grouped is None or grouped.load.shape[2] > patterns:
        return None
    loaded, numbers = np.unique(np.stack([grouped.normal, grouped.along]), return_inverse=True)
    normal, along = numbers.reshape(2, *grouped.normal.shape)[:, number]
    load, first = grouped.load[number], grouped.load[number, : inverses[1].shape[-1]]
    with one_thread():  # another number of threads would change the last bits
        every = spanned(inverses[0] @ load, grouped.lines)
        least = spanned(inverses[1] @ first, grouped.lines)
    starts, layers = _layers(clamped.chain, loaded, normal, grouped.lines)
    with one_thread():
        blocks = clamped.chain.blocks(loaded, layers, reported())
    heat, still = thermal.of_each_field(held.rail, held.operator, held.material, middle)
    warm = clamped.displaced(heat, still)[clamped.free]
    frequency, shape = held.modes(modes)
    own = clamped.chain.numbers(loaded)
    face = np.stack([(each >= 0).any(axis=0) for each in places])
    signs = np.array([held.images[row] for row in face.argmax(axis=0)])
    signs = np.concatenate([np.ones((len(signs), 1)), signs, np.ones((len(signs), 1))], axis=1)
    toward = np.array([patches.toward(place) for place in number[0]])
    kind = np.min_scalar_type(loaded.size)
    nodes = Nodal(
        normal=normal.astype(kind),
        along=along.astype(kind),
        share=every.share,
        shape=every.shape,
        share_first=least.share,
        shape_first=least.shape,
        starts=starts,
        layers=layers,
        blocks=blocks,
        swung=shape[own],
        heated=warm[own],
        signs=signs,
        toward=toward,
    )
    # in the order of a file, so that what follows has the same last bits
    return Nodal(*map(np.ascontiguousarray, nodes)), frequency


def _layers(
    chain: Chain, loaded: np.ndarray, normal: np.ndarray, lines: int
) -> tuple[np.ndarray, np.ndarray]:
    """First number (l+1,) of ``loaded`` in each layer, and the pairs (q,2) of layers under faces
    pressed at the same station, by ``normal`` (s,f,n) in so many ``lines``."""
    layer = chain.layer(loaded)
    count = int(layer.max()) + 1
    own = layer[normal[..., :: normal.shape[2] // lines]]
    found = []
    for face in range(own.shape[1]):
        one, other = own[:, face, None, :, None], own[:, face:, None, :]
        found.append(np.unique(np.minimum(one, other) * count + np.maximum(one, other)))
    layers = np.stack(np.divmod(np.unique(np.concatenate(found)), count), axis=1)
    return np.searchsorted(layer, np.arange(count + 1)), layers
