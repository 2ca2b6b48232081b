"""Frames of a run of the reference, seen from the platform: fields on the rails, positions of
payload and pads.

The axes are those of the platform, which coincide with scene axes at ignition. In these axes the motion
of the rails is only their deformation. Contact pressure is the pressure of the interface at the nodes of
the walls::

    p = k_p max(0, -h - relief (xi^4 + eta^4))    for |xi|, |eta| <= 1
    h: height of the node over the pad face

The run integrates this pressure at the Gauss points of the facets (``highfi.contact.pads``).
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.elements import hexahedral_recovery, hexahedron
from tipoff.highfi.stress import peaks
from tipoff.kernels import rotation
from tipoff.mechanics.model import Model
from tipoff.scenes.scene import Scene

_BATCH = 8192  # elements at once, which limits the memory
_PAD_DEPTH = 6e-3  # m, drawn thickness of pads; the scene has their faces only


class Frame(NamedTuple):
    """One instant: time (s); displacement (n,3) m of the mesh nodes, von_mises (n,) Pa as the mean
    over the elements that meet at a node, worst (e,) Pa at the worst node of each element, pressure
    (n,) Pa; turn (3,3) and centre (3,) m of the payload."""

    time: float
    displacement: np.ndarray
    von_mises: np.ndarray
    worst: np.ndarray
    pressure: np.ndarray
    turn: np.ndarray
    centre: np.ndarray


class Camera:
    """Takes frames of a ``highfi.simulation.Loop`` at its present sample; common data is computed once."""

    def __init__(self, loop):
        self.system, mesh = loop.setup.system, loop.setup.system.mesh
        self._shear, self._lame = loop.setup.monitor.shear_modulus, loop.setup.monitor.lame
        self._recovery, self._room = loop.setup.monitor.recovery, np.zeros(peaks.SIZE)
        self._meeting = np.bincount(mesh.cells.ravel(), minlength=len(mesh.points))
        self._walls = np.unique(
            np.concatenate(
                [facets for name, facets in mesh.surfaces.items() if name.startswith("contact")]
            )
        )

    def take(self, loop) -> Frame:
        """The frame of ``loop`` now."""
        state, system = loop.stepper.state, self.system
        displacement = loop.stepper.deformed()[system.number]
        mean, worst = self._stresses(loop.stepper.deformed())
        base, body = (
            rotation.matrices(part.quaternion[None])[0] for part in (state.platform, state.payload)
        )
        turn, centre = base.T @ body, base.T @ (state.payload.position - state.platform.position)
        return Frame(
            loop.stepper.time,
            displacement,
            von_mises=hexahedral_recovery.von_mises(mean),
            worst=worst,
            pressure=self._pressure(displacement, turn, centre),
            turn=turn,
            centre=centre + system.origin,
        )

    def _stresses(self, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean stress (n,6) Pa at the nodes, largest von Mises stress (e,) Pa at the nodes of each
        element; ``moved`` as in the loop."""
        mesh = self.system.mesh
        total, worst = np.zeros((len(mesh.points), 6)), np.zeros(len(mesh.cells))
        for first in range(0, len(mesh.cells), _BATCH):
            cells = mesh.cells[first : first + _BATCH]
            stress = self._law(
                peaks.gradients(moved, self._recovery, self._room, first, first + len(cells))
            )
            worst[first : first + len(cells)] = hexahedral_recovery.von_mises(stress).max(axis=1)
            for component in range(6):
                total[:, component] += np.bincount(
                    cells.ravel(), stress[..., component].ravel(), len(total)
                )
        return total / self._meeting[:, None], worst

    def _law(self, gradient: np.ndarray) -> np.ndarray:
        """Hooke's law: stress (...,6) Pa of displacement gradients (...,3,3)."""
        stress = self._shear * (gradient + np.swapaxes(gradient, -1, -2))
        stress[..., range(3), range(3)] += (
            self._lame * np.trace(gradient, axis1=-2, axis2=-1)[..., None]
        )
        return stress[..., [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]

    def _pressure(
        self, displacement: np.ndarray, turn: np.ndarray, centre: np.ndarray
    ) -> np.ndarray:
        """Contact pressure (n,) Pa; ``turn`` and ``centre`` of the payload in frame axes."""
        pressure, faces, interface_stiffness = (
            np.zeros(len(displacement)),
            self.system.faces,
            self.system.model.interface_stiffness,
        )
        if interface_stiffness is None:
            return pressure
        place = (
            self.system.mesh.points[self._walls] - self.system.origin + displacement[self._walls]
        )
        seen = (place - centre) @ turn
        for face in range(faces.axis.size):
            axis = faces.axis[face]
            along = (seen[:, 0] - faces.centre[face, 0]) / faces.half_length[face]
            across = (seen[:, 3 - axis] - faces.centre[face, 3 - axis]) / faces.half_width[face]
            height = faces.sign[face] * (seen[:, axis] - faces.centre[face, axis])
            under = (np.abs(along) <= 1.0) & (np.abs(across) <= 1.0) & (np.abs(height) < _PAD_DEPTH)
            depth = np.where(under, -height - faces.relief[face] * (along**4 + across**4), 0.0)
            pressure[self._walls] += interface_stiffness * np.maximum(depth, 0.0)
        return pressure


def bodies(scene: Scene, model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Boxes (b,8,3) m in payload axes from its mass centre, corners in VTK order: the payload, then
    a slab behind each pad face; and the number (b,) of its pad counted from 1, 0 for the payload.
    Without a size in the scene, the payload is the box around its pads."""
    faces, middle = model.faces, -np.array(model.payload.mass_centre)
    reach = np.abs([pad.position for pad in scene.pads]).max(axis=0)
    half = 0.5 * np.array(scene.payload.size) if scene.payload.size else reach
    boxes = [_box(middle - half, middle + half)]
    for face in range(faces.axis.size):
        extent = np.array([faces.half_length[face], faces.half_width[face], faces.half_width[face]])
        extent[faces.axis[face]] = 0.5 * _PAD_DEPTH
        centre = faces.centre[face].copy()
        centre[faces.axis[face]] -= 0.5 * faces.sign[face] * _PAD_DEPTH
        boxes.append(_box(centre - extent, centre + extent))
    return np.array(boxes), np.append(0, faces.pad + 1)


def _box(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return np.where(hexahedron.VTK_CORNERS == 1, high, low)
