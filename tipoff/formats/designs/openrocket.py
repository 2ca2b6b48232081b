"""Designs of OpenRocket, ``.ork``: XML, plain, in a zip archive or compressed by gzip. Lengths are in m,
masses in kg, angles in deg.

The state at launch is the first point of the first simulation with stored data: OpenRocket writes it
when a design is saved with its results. A table of a simulation (``openrocket_table``) takes its place.
Places are distances behind the tip of the nose. A file with a document type is refused, so nothing can
define an entity.
"""

import gzip
import io
import zipfile
from collections.abc import Iterator
from typing import NamedTuple
from xml.etree import ElementTree
from xml.parsers import expat

from tipoff.formats.designs.openrocket_table import COLUMNS, Simulation, sources

_LARGEST = 100_000_000  # bytes of XML
_OUTSIDE = ("nosecone", "bodytube", "transition")
_STATE = {key: name for key, (name, _) in COLUMNS.items()}


class Lug(NamedTuple):
    """A launch lug (m)."""

    inner: float  # diameter
    length: float


class Design(NamedTuple):
    """What a design says, in SI and degrees; ``sources`` names the field of each value."""

    length: float
    diameter: float
    guides: tuple[float, ...]  # places of the middles of buttons, or of lugs where there are none
    neck: float | None  # diameter of the neck of the buttons
    lug: Lug | None  # the first of the lugs
    mass: float
    mass_centre: float
    across: float  # kg m2
    along: float
    rail_length: float
    rail_angle: float  # from the vertical
    curve: tuple[tuple[float, float], ...]  # time (s) and thrust (N)
    sources: dict[str, str]


def read_openrocket(
    data: bytes, file: str = "design", simulated: Simulation | None = None
) -> Design:
    """The design in the bytes of a ``file``, with the state and the thrust of a table where one is
    ``simulated``. Raises ValueError with every value that is missing."""
    root = _root(_text(data))
    missing: list[str] = []
    outside = list(_outside(root))
    if not outside:
        missing.append("a nose cone or a body tube")
    length = sum(each[2] for each in outside)
    radii = [radius for part, _, _ in outside for radius in _radii(part)]
    if outside and not radii:
        missing.append("a radius of the body")
    guides, guide, words = _guides(outside)
    neck, lug = (None, guide) if isinstance(guide, Lug) else (guide, None)
    if len(guides) < (1 if lug else 2):
        missing.append("two rail buttons or a launch lug with radius, thickness and length")
    stored, conditions, simulation = _simulation(root, file)
    state = simulated or stored
    if state is None:
        missing.append(
            "a simulation with stored data (mass, CG location, both moments of inertia, thrust): run it in "
            "OpenRocket and save the design with its results, or give the table that it exports too"
        )
    rod = [_number(conditions, f"launchrod{name}") for name in ("length", "angle")]
    missing += [f"launchrod{n}" for n, v in zip(("length", "angle"), rod) if v is None]
    if missing or state is None or rod[0] is None or rod[1] is None:
        raise ValueError(f"a design that states {'; '.join(missing)}")
    return Design(
        length=length,
        diameter=2.0 * max(radii),
        guides=guides,
        neck=neck,
        lug=lug,
        mass=state.mass,
        mass_centre=state.mass_centre,
        across=state.across,
        along=state.along,
        rail_length=rod[0],
        rail_angle=abs(rod[1]),
        curve=state.curve,
        sources={
            "payload.length": f"{file}: nosecone, bodytube, transition: length",
            "payload.diameter": f"{file}: nosecone, bodytube, transition: radius",
            "lugs" if lug else "buttons": f"{file}: {words}",
            "rail.end": f"{file}: simulation {simulation!r}, launchrodlength",
            "gravity.inclination": f"{file}: simulation {simulation!r}, launchrodangle",
        }
        | state.sources,
    )


def _text(data: bytes) -> bytes:
    if data[:4] == b"PK\x03\x04":
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                names = [name for name in archive.namelist() if name.endswith(".ork")]
                if not names:
                    raise ValueError("an archive with a file .ork")
                with archive.open(names[0]) as stream:
                    found = stream.read(_LARGEST + 1)
        except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as fault:
            raise ValueError(f"a whole zip archive ({fault})") from fault
    elif data[:2] == b"\x1f\x8b":
        try:
            with gzip.GzipFile(fileobj=io.BytesIO(data)) as stream:
                found = stream.read(_LARGEST + 1)
        except (OSError, EOFError) as fault:
            raise ValueError(f"a whole gzip file ({fault})") from fault
    else:
        found = data
    if len(found) > _LARGEST:
        raise ValueError(f"at most {_LARGEST:,} bytes of XML")
    return found


def _root(text: bytes) -> ElementTree.Element:
    def refuse(*_: object) -> None:
        raise ValueError("XML without a document type")

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text, True)
        root = ElementTree.fromstring(text)
    except (expat.ExpatError, ElementTree.ParseError) as fault:
        raise ValueError(f"valid XML ({fault})") from fault
    if root.tag != "openrocket":
        raise ValueError(f"a design of OpenRocket, with the element openrocket, not {root.tag}")
    return root


def _outside(root: ElementTree.Element) -> Iterator[tuple[ElementTree.Element, float, float]]:
    """(component, place of its front end, length) of the body, from the nose through all stages."""
    place = 0.0
    for stage in root.findall("rocket/subcomponents/stage"):
        for part in stage.findall("subcomponents/*"):
            if part.tag in _OUTSIDE:
                length = _number(part, "length") or 0.0
                yield part, place, length
                place += length


def _radii(part: ElementTree.Element) -> list[float]:
    found = [_number(part, name) for name in ("radius", "aftradius", "foreradius")]
    return [radius for radius in found if radius is not None]


def _guides(outside: list) -> tuple[tuple[float, ...], Lug | float | None, str]:
    """Places of the buttons, or of the lugs where there are none, the first lug or the neck of a button, and the
    field."""
    buttons: list[float] = []
    lugs: list[float] = []
    neck = lug = None
    for part, front, length in outside:
        for item in part.iter():
            places = (place for place, _ in _places(item, front, length))
            if item.tag == "railbutton":
                buttons += places
                neck = neck or _number(item, "innerdiameter")
            elif item.tag == "launchlug" and (own := _lug(item)):
                lugs += places
                lug = lug or own
    if buttons:
        return tuple(sorted(buttons)), neck, "railbutton: axialoffset, instanceseparation"
    return tuple(sorted(lugs)), lug, "launchlug: axialoffset, radius, thickness, length"


def _lug(item: ElementTree.Element) -> Lug | None:
    """The sizes of a lug; None if one is missing."""
    radius, thickness, length = (_number(item, name) for name in ("radius", "thickness", "length"))
    if radius is None or thickness is None or length is None:
        return None
    inner = 2.0 * (radius - thickness)
    return Lug(inner, length) if inner > 0.0 and length > 0.0 else None


def _places(item: ElementTree.Element, front: float, whole: float) -> list[tuple[float, float]]:
    """(place of the middle, length) of each instance on a part at ``front`` of length ``whole``."""
    own = (_number(item, "length") or 0.0) if item.tag == "launchlug" else 0.0
    stated = item.find("axialoffset")
    stated = item.find("position") if stated is None else stated
    way = "top" if stated is None else stated.get("method", stated.get("type", "top"))
    offset = 0.0 if stated is None else _float(stated.text) or 0.0
    begin = {
        "absolute": offset,
        "bottom": front + whole - own + offset,
        "middle": front + 0.5 * (whole - own) + offset,
    }.get(way, front + offset)
    count = int(_number(item, "instancecount") or 1)
    step = _number(item, "instanceseparation") or 0.0
    return [(begin + 0.5 * own + number * step, own) for number in range(min(count, 1000))]


def _simulation(root: ElementTree.Element, file: str) -> tuple:
    """The first simulation with data, None without one, and its conditions and name; else those of the
    first one."""
    every = root.findall("simulations/simulation")
    for each in every:
        branch = each.find("flightdata/databranch")
        names = [] if branch is None else branch.get("types", "").split(",")
        points = [] if branch is None else branch.findall("datapoint")
        if not points or not {*_STATE.values(), "Time", "Thrust"} <= set(names):
            continue
        rows = [dict(zip(names, (point.text or "").split(","))) for point in points]
        first = {key: _float(rows[0].get(name)) for key, name in _STATE.items()}
        state = {key: value for key, value in first.items() if value is not None and value > 0.0}
        curve = [(_float(row.get("Time")), _float(row.get("Thrust"))) for row in rows]
        if len(state) < len(_STATE):
            continue
        whole = tuple((t, f) for t, f in curve if t is not None and f is not None)
        name = each.findtext("name", "")
        place = f"{file}: simulation {name!r}, databranch"
        fields = sources(f"{place}, first datapoint", _STATE, f"{place}, Time and Thrust")
        return Simulation(curve=whole, sources=fields, **state), each.find("conditions"), name
    conditions = every[0].find("conditions") if every else None
    return None, conditions, every[0].findtext("name", "") if every else ""


def _number(part: ElementTree.Element | None, name: str) -> float | None:
    return None if part is None else _float(part.findtext(name))


def _float(text: str | None) -> float | None:
    """A finite number; "auto 0.025" is the value that OpenRocket computed."""
    try:
        found = float((text or "").removeprefix("auto").strip())
    except ValueError:
        return None
    return found if abs(found) < 1e9 else None
