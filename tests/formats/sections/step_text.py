"""A prism as STEP text, in the style of CAD programs that are not OpenCASCADE: blanks around brackets,
no curves on surfaces, lengths in inches or another unit."""

import math

MM = "( LENGTH_UNIT ( ) NAMED_UNIT ( * ) SI_UNIT ( .MILLI., .METRE. ) )"
INCH = (
    "( CONVERSION_BASED_UNIT ( 'INCH', #{measure} ) LENGTH_UNIT ( ) NAMED_UNIT ( $ ) )",
    "LENGTH_MEASURE_WITH_UNIT ( LENGTH_MEASURE( 25.4 ), #{mm} )",
)


class Text:
    """Lines of instances, numbered from 1 on."""

    def __init__(self):
        self.lines: list[str] = []

    def add(self, text: str) -> str:
        """The reference of a new instance."""
        self.lines.append(f"#{len(self.lines) + 1} = {text} ;")
        return f"#{len(self.lines)}"

    def point(self, place) -> str:
        return self.add(f"CARTESIAN_POINT ( 'NONE',  ( {', '.join(map(_real, place))} ) )")

    def direction(self, along) -> str:
        length = math.hypot(*along)
        numbers = ", ".join(_real(part / length) for part in along)
        return self.add(f"DIRECTION ( 'it''s; /* one */ #1', ( {numbers} ) )")

    def line(self, start, end, ends) -> str:
        along = [b - a for a, b in zip(start, end)]
        vector = self.add(f"VECTOR ( 'NONE', {self.direction(along)}, 1.0 )")
        line = self.add(f"LINE ( 'NONE', {self.point(start)}, {vector} )")
        return self.add(f"EDGE_CURVE ( 'NONE', {ends[0]}, {ends[1]}, {line}, .T. )")

    def face(self, corner, normal, edges, surface="PLANE") -> str:
        oriented = [self.add(f"ORIENTED_EDGE ( 'NONE', *, *, {edge}, .T. )") for edge in edges]
        loop = self.add(f"EDGE_LOOP ( 'NONE', ( {', '.join(oriented)} ) )")
        bound = self.add(f"FACE_OUTER_BOUND ( 'NONE', {loop}, .T. )")
        axis = self.direction(normal)
        place = self.add(f"AXIS2_PLACEMENT_3D ( 'NONE', {self.point(corner)}, {axis}, $ )")
        plane = self.add(f"{surface} ( 'NONE', {place} )")
        return self.add(f"ADVANCED_FACE ( 'NONE', ( {bound} ), {plane}, .T. )")


def _real(number: float) -> str:
    return f"{number:.12G}" if "." in f"{number:.12G}" else f"{number:.1f}"


def prism(corners, length, unit="mm", solid="MANIFOLD_SOLID_BREP", rest=()) -> str:
    """A prism with ``corners`` (x, y) and ends at z = 0 and ``length``, as a ``solid`` of such a name;
    further instances ``rest``. ``unit``: mm, in, or none."""
    text = Text()
    levels = [[(*corner, z) for corner in corners] for z in (0.0, length)]
    vertices = [
        [text.add(f"VERTEX_POINT ( 'NONE', {text.point(place)} )") for place in level]
        for level in levels
    ]
    after = [(place + 1) % len(corners) for place in range(len(corners))]
    rings = [
        [
            text.line(level[a], level[b], (ends[a], ends[b]))
            for a, b in zip(range(len(after)), after)
        ]
        for level, ends in zip(levels, vertices)
    ]
    posts = [
        text.line(levels[0][a], levels[1][a], (vertices[0][a], vertices[1][a]))
        for a in range(len(corners))
    ]
    faces = [text.face(levels[end][0], (0, 0, 1), rings[end]) for end in (0, 1)]
    for a, b in zip(range(len(after)), after):
        (y, z), (to_y, to_z) = corners[a], corners[b]
        edges = (rings[0][a], posts[b], rings[1][a], posts[a])
        faces.append(text.face(levels[0][a], (to_z - z, y - to_y, 0), edges))
    shell = text.add(f"CLOSED_SHELL ( 'NONE', ( {', '.join(faces)} ) )")
    body = text.add(f"{solid} ( 'Boss-Extrude1', {shell} )")
    _representation(text, body, unit)
    for line in rest:
        text.add(line)
    return (
        "ISO-10303-21;\nHEADER;\nFILE_SCHEMA (( 'CONFIG_CONTROL_DESIGN' ));\nENDSEC;\nDATA;\n"
        + "/* made; by hand\n #1 = NOTHING ( ) ; */\n"
        + "\n".join(text.lines)
        + "\nENDSEC;\nEND-ISO-10303-21;\n"
    )


def _representation(text: Text, body: str, unit: str) -> None:
    units = [text.add("( NAMED_UNIT ( * ) PLANE_ANGLE_UNIT ( ) SI_UNIT ( $, .RADIAN. ) )")]
    if unit != "none":
        units.append(text.add(MM))
    if unit == "in":
        measure = text.add(INCH[1].format(mm=units.pop()[1:]))
        units.append(text.add(INCH[0].format(measure=measure[1:])))
    context = text.add(
        "( GEOMETRIC_REPRESENTATION_CONTEXT ( 3 ) "
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT ( ( {', '.join(units)} ) ) "
        "REPRESENTATION_CONTEXT ( 'NONE', 'WORKSPACE' ) )"
    )
    text.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION ( 'rail', ( {body} ), {context} )")
