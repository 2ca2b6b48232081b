"""Table of pad faces for the kernels of the surrogate: one row per face."""

import numpy as np

from tipoff.mechanics.model import Model

# Columns: centre in payload body axes (m); y and z of the outward normal, and the distance of the
# wall along it (m), in platform axes; half the length (m); its number. For the ends of the wall
# (``lowfi.contact.wall_ends``): largest distance (m) of the middle of the face beyond an end of the
# rail, its centred place across the rail (m, platform axes) and the largest distance (m) from
# there, the thickness of the wall (m), and the depth (m) at which its edge may still pass that of
# the wall. Last the number of its guide.
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
    GUIDE,
    FACE_SIZE,
) = (0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14)
ROUNDED = 1e-6  # m, least radius of the edges of pads and walls, and least accuracy of a gap
LAST_STRIP = 0.01  # of half a face: the part still over a compliant wall when the face leaves it


def table(model: Model, compliance) -> np.ndarray:
    """The table (f, FACE_SIZE) of ``model``; ``compliance``: record of compliant contact, or
    None."""
    faces = model.faces
    found = np.zeros((faces.axis.size, FACE_SIZE))
    found[:, CENTRE : CENTRE + 3] = faces.centre
    found[:, NORMAL_Y] = np.where(faces.axis == 1, faces.sign, 0.0)
    found[:, NORMAL_Z] = np.where(faces.axis == 2, faces.sign, 0.0)
    found[:, WALL], found[:, HALF_LENGTH] = faces.sign * faces.wall, faces.half_length
    found[:, NUMBER], found[:, GUIDE] = np.arange(faces.axis.size), faces.guide
    if compliance is not None:
        found[:, OVERHANG] = compliance.half[:, 0] * (1.0 - LAST_STRIP)
    found[:, SIDE_MIDDLE], found[:, SIDE_REACH] = (
        model.plate.across,
        model.plate.leg + faces.half_width,
    )
    found[:, BACK], found[:, ROUND] = model.plate.thickness, faces.relief + ROUNDED
    return found
