"""Rails at rest: no pad has touched them yet, or the payload has left them. They are not stepped.

A rail at rest belongs to the rigid part of its platform. On a fixed platform this is exact until a
pad touches it. On a free platform the rail follows the platform's acceleration as in statics
(``statics.inertial``). This deflection is a few nanometres. It is left out while the rail rests and
added when the rail is stepped again. So only vibration is left out; ``dynamics.jolts`` measures it,
and the rail is stepped again when it exceeds ``MOST_LEFT_OUT``.

This module has the constants: the rails that can rest, and the records of a platform with rails at
rest. ``dynamics.regroup`` lets rails rest and wakes them, ``dynamics.waking`` decides when.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics.step_limit import of_pushers
from tipoff.highfi.dynamics.step_size import Stepping, raster_steps
from tipoff.highfi.dynamics.system import System, with_moving_walls
from tipoff.highfi.mesh import pieces
from tipoff.highfi.state import records
from tipoff.highfi.statics.inertial import TERMS, Deflection, deflections
from tipoff.mechanics.laws import thrust
from tipoff.mechanics.laws.thrust import sample
from tipoff.scenes.scene import Scene

MOST_LEFT_OUT = 1e-9  # m, vibration of the walls
# nodes of a solid; the factor of a larger one would take more memory than the run
MOST_NODES = 20_000
_MOST_STRIDE = 10  # steps in one long step
# of the narrowest pulse: the trapezoidal sum then has a relative error of 3e-7 where the pulse is
# cut
_SHARE_OF_PULSE = 1.0 / 500.0
_JUMP = 1e-9  # of the largest thrust


class Rails(NamedTuple):
    """Rails that can rest: one by one if the mesh is sorted by rails, else all together."""

    blocks: list[np.ndarray]  # numbers of the blocks of each
    groups: np.ndarray  # (rails, g) whether pads of a group can touch a rail
    deflections: list[list[Deflection]]  # of the solids of each rail; empty on a fixed platform
    # (s,TERMS) m, of the walls of the s solids without mirror images, see ``Deflection``
    size: np.ndarray
    frequency: np.ndarray  # (s,1) rad/s, the lowest of each
    at_ignition: bool  # whether rails may rest before the first touch
    stride: int  # steps in one long step, which is taken while all rails rest
    jumps: np.ndarray  # s, where the thrust jumps


def build(scene: Scene, system: System, stepping: Stepping) -> Rails | None:
    """Rails that can rest. None if this is unknown: on a free platform, with a rail that nothing
    holds or with a large one."""
    solids, blocks = pieces.nodes(system.mesh), system.rail.blocks
    found: tuple[Deflection, ...] = ()
    if system.frame is not None:
        solved = deflections(system.mesh, scene.rail.material, scene.rail.joint(), most=MOST_NODES)
        if solved is None:
            return None
        found = solved
    parts = [
        np.unique(np.searchsorted(blocks, system.number[own], side="right") - 1) for own in solids
    ]
    whole = np.arange(blocks.size - 1)
    if system.rail.columns is None:
        parts, grouped = [whole], [list(found)]
    else:
        grouped = [[each] for each in found] or [[] for _ in parts]
    followed = [np.stack([each.size, each.frequency]) for each in found]
    size, frequency = np.unique(followed or np.zeros((0, 2, TERMS)), axis=0).transpose(1, 0, 2)
    lowest = frequency.min(axis=1, initial=np.inf, where=frequency > 0.0, keepdims=True)
    raster = raster_steps(stepping, scene.output.interval)
    return Rails(
        blocks=parts,
        groups=_groups(system, parts),
        deflections=grouped,
        # A constant body force acts on the rails of a fixed platform from ignition on.
        at_ignition=system.frame is not None or system.model.body_force is None,
        size=size,
        frequency=np.where(np.isfinite(lowest), lowest, 0.0),
        # Samples may be at any multiple of the raster, so long steps must not pass it.
        stride=_stride(system, stepping.dt_s, raster),
        jumps=_jumps(system.model.thrust, scene.time_limit),
    )


def _groups(system: System, parts: list[np.ndarray]) -> np.ndarray:
    surface, groups = system.surface, system.surface.groups
    reached = np.zeros((len(parts), groups.first_face.size - 1), dtype=np.bool_)
    for group in range(reached.shape[1]):
        for face in groups.face[groups.first_face[group] : groups.first_face[group + 1]]:
            wall = surface.search.wall[face]
            if wall < 0:
                continue
            first = surface.search.first_bin[wall]
            begin, end = surface.search.first_facet[
                [first, first + surface.search.bins[wall].prod()]
            ]
            nodes = surface.facets[surface.search.facet[begin:end]]
            block = np.unique(np.searchsorted(system.rail.blocks, nodes, side="right") - 1)
            reached[:, group] |= [bool(np.isin(block, part).any()) for part in parts]
    return reached


def _stride(system: System, step: float, raster: int) -> int:
    """Largest number of steps (s) in a long step that divides the ``raster`` and resolves the
    thrust."""
    law, pushers = system.model.thrust, of_pushers(system)
    share = 1.0 if law.pulses is None else _SHARE_OF_PULSE
    resolved = share * thrust.shortest_feature(law)
    if (fastest := pushers.damping + np.sqrt(pushers.stiffness)) > 0.0:
        resolved = min(resolved, _SHARE_OF_PULSE / fastest)
    most = int(min(_MOST_STRIDE, resolved / step))
    return max((k for k in range(1, most + 1) if raster % k == 0), default=1)


def _jumps(law: thrust.Thrust, duration: float) -> np.ndarray:
    """Times (s) after ignition where the thrust itself jumps."""
    times = thrust.corners(law, duration)
    before, after = sample(law, np.nextafter(times, -np.inf)), sample(law, np.nextafter(times, 1e9))
    return times[np.abs(after - before) > _JUMP * thrust.peak(law, duration)]


def view(system: System, rails: Rails, rests: np.ndarray) -> System:
    """``system`` while the rails ``rests`` (rails,) rest."""
    stepped = np.zeros(len(system.moving_mass), dtype=np.bool_)
    for part, at_rest in zip(rails.blocks, rests):
        for block in part:
            stepped[system.rail.blocks[block] : system.rail.blocks[block + 1]] = not at_rest
    moving = np.where(stepped, system.moving_mass, 0.0)
    used = np.flatnonzero(stepped)
    return system._replace(
        moving_mass=moving,
        nodes=slice(int(used[0]), int(used[-1]) + 1) if used.size else slice(0, 0),
        surface=with_moving_walls(system.surface, moving),
        drive=system.drive._replace(moving_mass=float(moving.sum())),
        frame=None if system.frame is None else _with(system, system.moving_mass - moving),
    )


def _with(system: System, carried: np.ndarray) -> records.Frame:
    """The rigid part with additional masses ``carried`` (n,) kg at the nodes (parallel axes)."""
    alone, points = system.frame, system.rail.points
    assert alone is not None
    if not carried.any():
        return alone
    mass = alone.mass + carried.sum()
    centre = carried @ points / mass
    products = np.einsum("n,ni,nj->ij", carried, points, points) - mass * np.outer(centre, centre)
    inertia = np.linalg.inv(alone.inverse_inertia) + np.trace(products) * np.eye(3) - products
    return alone._replace(mass=float(mass), centre=centre, inverse_inertia=np.linalg.inv(inertia))
