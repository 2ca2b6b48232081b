"""Element types of Abaqus and CalculiX by their names, and the nodes of the faces of solids.

See the sections "Element library" and "Element-based surface definition" of the Abaqus guides.
"""

import re

from tipoff.highfi.mesh.files.tables import Unreadable

_SOLIDS = {
    4: "tetra",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    15: "wedge15",
    20: "hexahedron20",
    27: "hexahedron27",
}
_FACES = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}
_SOLID = re.compile(r"^(?:C3D|DC3D|AC3D)(\d+)[A-Z]*$")
_FACE = re.compile(r"^(?:S|M3D|SFM3D|R3D|CPS|CPE|CAX|DS|DC2D)(\d)[A-Z]*\d?$")
_TRIANGULAR_SHELLS = {"STRI3": 3, "STRI65": 6}
# elements of lines and points, which carry no surface
_OTHER = re.compile(
    r"^(?:T2D|T3D|B2|B3|PIPE|ELBOW|FRAME|R2D|RAX|RB|MASS|ROTARYI|SPRING|DASHPOT|GAP|CONN|DCOUP|"
    r"SAX|HEATCAP|D$|U1$)"
)

# Corners of the faces S1, S2, ... of solids, as places in the list of nodes of an element.
_OF_HEXAHEDRON = (
    "quad",
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]],
)
_OF_TETRAHEDRON = ("triangle", [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
FACES = {
    **dict.fromkeys(("hexahedron", "hexahedron20", "hexahedron27"), _OF_HEXAHEDRON),
    **dict.fromkeys(("tetra", "tetra10"), _OF_TETRAHEDRON),
}


def known(name: str) -> tuple[str, int] | None:
    """Name in meshio and number of nodes of an element type; None for elements of lines and points.

    Raises Unreadable for a type that is not known, which may be a solid.
    """
    plain = name.upper()
    if found := _SOLID.match(plain):
        nodes, names = int(found[1]), _SOLIDS
    elif plain in _TRIANGULAR_SHELLS:
        nodes, names = _TRIANGULAR_SHELLS[plain], _FACES
    elif found := _FACE.match(plain):
        nodes, names = int(found[1]), _FACES
    else:
        if _OTHER.match(plain):
            return None
        nodes, names = 0, {}
    if nodes not in names:
        raise Unreadable(
            f"elements of type {name[:40]}, which are not known; solids are C3D8 or C3D10, surfaces "
            "are shells such as S4 or STRI65"
        )
    return names[nodes], nodes
