"""The table of pad faces of the kernels of the surrogate: one row per face."""

import numpy as np

from tipoff.mechanics.model import Model

# Columns: centre in payload body axes (m); outward normal's y and z and the wall's distance along it
# (m), in platform axes; half the length (m); its own number; and for the ends of the wall
# (``lowfi.contact.wall_ends``): how far (m) the middle of the face may be beyond an end of the rail,
# its place across the rail when centred (m, platform axes), how far from there it may be (m), the
# thickness of the wall (m), and how deep (m) its edge may pass that of the wall.
(
    CENTRE,
    NORMAL_Y,
    NORMAL_Z,
    WALL,
    HALF_LENGTH,
    NUMBER,
    OVERHANG,
    SIDE_MIDDLE,
    SIDE_REACH,
    BACK,
    ROUND,
    FACE_SIZE,
) = (0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13)
ROUNDED = 1e-6  # m: edges of pads and walls are no sharper, and no gap is more accurate
LAST_STRIP = 0.01  # of half a face: what is still over a compliant wall when the face leaves it


def table(model: Model, compliance) -> np.ndarray:
    """The table (f, FACE_SIZE) of ``model``, on compliant contact with its record ``compliance``."""
    faces = model.faces
    found = np.zeros((faces.axis.size, FACE_SIZE))
    found[:, CENTRE : CENTRE + 3] = faces.centre
    found[:, NORMAL_Y] = np.where(faces.axis == 1, faces.sign, 0.0)
    found[:, NORMAL_Z] = np.where(faces.axis == 2, faces.sign, 0.0)
    found[:, WALL], found[:, HALF_LENGTH] = faces.sign * faces.wall, faces.half_length
    found[:, NUMBER] = np.arange(faces.axis.size)
    if compliance is not None:
        found[:, OVERHANG] = compliance.half[:, 0] * (1.0 - LAST_STRIP)
    found[:, SIDE_MIDDLE], found[:, SIDE_REACH] = (
        model.plate.across,
        model.plate.leg + faces.half_width,
    )
    found[:, BACK], found[:, ROUND] = model.plate.thickness, faces.relief + ROUNDED
    return found
