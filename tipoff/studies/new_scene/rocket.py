"""A scene of a rocket on its rail from a few numbers, in the words of its hardware.

Without numbers it is a rocket like that of the scene ``rocket_rail``. Other sizes keep its proportions:
the mass centre at 0.47 of the length, one button there and one at 0.06.
"""

from collections.abc import Mapping

import tomlkit

from tipoff.files import read_input
from tipoff.formats.designs.openrocket import Design
from tipoff.scenes.parts import usual
from tipoff.scenes.parts.profiles import PROFILES
from tipoff.scenes.reading import CATALOG, FORMAT
from tipoff.studies.new_scene import from_catalogue

_CENTRE, _REAR = 0.46875, 0.0625  # of the length, as on the scene rocket_rail
_INCLINATION, _ERROR = 85.0, 0.5  # deg

_TEXT = """\
# A rocket with {guided}. Places count from its tail: write yours. provenance says what is given and assumed.
format = {format}
name = {named}  # "tipoff scenes --show {name}.toml" writes out pads, profile, inertia and all else that follows
origin = "tail"
gravity = {{ inclination = "{inclination:g} deg" }}  # of the rail
initial = {{ settled = true }}  # the rocket {rests}
contact = {{ law = "impact" }}  # the rest follows from the material of the {part}
friction = {{ static = 0.2, dynamic = 0.2 }}
thrust_offset = {{ misalignment = {{ axial = "0.1 deg", radial = "0 deg" }} }}
thrust = {{ kind = "measured", {curve}, reaction = "exhaust" }}  # the nozzle is at the tail, or state its arm
output = {{ interval = "0.5 ms" }}
studies = {{ errors = {errors}, element_size = "{element}", rail_modes = 8 }}
provenance = {{ {sources} }}
[payload]
mass = "{mass:.6g} kg"
length = "{length:.6g} m"
diameter = "{diameter:.6g} mm"
mass_centre = "{centre:.6g} m"{inertia}
[[{part}]]
place = "{rear:.6g} m"
{first}
{front}
[rail]
start = "0 m"
end = "{rail:.6g} m"
mounts = [{mounts}]{section}
"""
_BUTTON = """\
profile = "{profile}"  # or 1010, 1515; or neck, neck_height, head and flange of your button
material = "acetal"  # or nylon, aluminium{play}"""
_LUG = """\
inner_diameter = "{inner:.6g} mm"
length = "{length:.6g} mm"
material = "nylon"  # or acetal, aluminium"""
_PLAY, _LUG_LENGTH = 0.25e-3, 30e-3  # m


def text(
    name: str,
    given: Mapping[str, float],
    size: tuple[float, float] | None,
    thrust_curve: Mapping[str, str] | None,
) -> str:
    """The scene as TOML with the ``given`` numbers (SI) by name of the option, length and diameter
    (m), and the keys of the ``[thrust]`` of a curve."""
    length, diameter = size or (1.6, 0.08)
    rail = given.get("rail_length", 2.0)
    play = given.get("clearance", _PLAY)
    if "rod" in given:
        rod = given["rod"]
        guided = _on_rod(rod, rod + 2.0 * play, _LUG_LENGTH)
    else:
        each = f'"{1e3 * play:.6g} mm"'
        stated = f"\nneck_to_slot = {each}\nhead_to_lip = {each}" if "clearance" in given else ""
        guided = _in_slot("4040 slot 8", stated, rail)
    curve = thrust_curve or {"file": "j360_start.csv"}
    centre, rear = _CENTRE * length, _REAR * length
    return _TEXT.format(
        format=FORMAT,
        name=name,
        named=tomlkit.item(name).as_string(),
        inclination=_INCLINATION,
        curve=", ".join(f"{key} = {tomlkit.item(own).as_string()}" for key, own in curve.items()),
        errors=tomlkit.item(from_catalogue.errors_file(name)).as_string(),
        sources=_sources(given, size, thrust_curve),
        mass=given.get("mass", 5.0),
        length=length,
        diameter=1e3 * diameter,
        centre=centre,
        rear=rear,
        front=_further(guided["part"], centre),
        inertia="",
        rail=rail,
        **guided,
    )


def of_design(name: str, design: Design, curve: str) -> str:
    """The scene as TOML for a ``design``, whose thrust is in the file ``curve``. Each value has its file and
    field as provenance."""
    rear, *others = sorted(design.length - place for place in design.guides)
    moments = {"xx": design.along, "yy": design.across, "zz": design.across}
    inertia = ", ".join(f'{axis} = "{value:.6g} kg*m**2"' for axis, value in moments.items())
    if design.lug is None:
        small = design.neck is None or design.neck < PROFILES["1010"].slot
        guided = _in_slot("1010" if small else "1515", "", design.rail_length)
    else:
        guided = _on_rod(usual.rod_in(design.lug.inner), *design.lug)
    sources = {"buttons": "assumed: the profile"} if design.lug is None else {}
    sources |= {"rail": "assumed", "thrust_offset": "assumed"} | _materials(guided["part"])
    sources |= design.sources
    sources |= dict.fromkeys(("payload.size",), sources["payload.length"])
    sources["thrust.arm"] = "assumed: the nozzle at the tail"
    return _TEXT.format(
        format=FORMAT,
        name=name,
        named=tomlkit.item(name).as_string(),
        inclination=90.0 - design.rail_angle,
        curve=f"file = {tomlkit.item(curve).as_string()}",
        errors=tomlkit.item(from_catalogue.errors_file(name)).as_string(),
        sources=", ".join(
            f'"{key}" = {tomlkit.item(own).as_string()}' for key, own in sources.items()
        ),
        mass=design.mass,
        length=design.length,
        diameter=1e3 * design.diameter,
        centre=design.length - design.mass_centre,
        rear=rear,
        front="\n".join(_further(guided["part"], place) for place in others),
        inertia=f"\ninertia = {{ {inertia} }}",
        rail=design.rail_length,
        **guided,
    )


def csv(design: Design) -> str:
    """The thrust of a ``design`` until burnout as CSV."""
    last = max((n for n, (_, force) in enumerate(design.curve) if force > 0.0), default=0)
    rows = design.curve[: last + 2]
    kept = [row for n, row in enumerate(rows) if n == 0 or row[0] > rows[n - 1][0]]
    return "time_s,force_N\n" + "".join(f"{time:g},{force:g}\n" for time, force in kept)


def _in_slot(profile: str, play: str, rail: float) -> dict[str, str]:
    """What is of buttons in the text, on a ``rail`` (m) with this profile."""
    return {
        "guided": "two rail buttons",
        "part": "buttons",
        "rests": "lies on the rail",
        "first": _BUTTON.format(profile=profile, play=play),
        "mounts": _mounts(usual.mounts(rail)),
        "section": "",
        "element": usual.element_size(rail),
    }


def _on_rod(rod: float, inner: float, length: float) -> dict[str, str]:
    """What is of lugs with these sizes (m) in the text, on a ``rod`` of this diameter (m)."""
    return {
        "guided": "launch lugs on a rod",
        "part": "lugs",
        "rests": "hangs below the rod",
        "first": _LUG.format(inner=1e3 * inner, length=1e3 * length),
        "mounts": _mounts(usual.foot()),
        "section": f'\nsection = {{ shape = "rod", diameter = "{1e3 * rod:.6g} mm" }}',
        "element": usual.rod_element_size(rod),
    }


def _materials(part: str) -> dict[str, str]:
    words = "assumed: nylon on steel" if part == "lugs" else "assumed: acetal on aluminium"
    return dict.fromkeys(("contact", "friction"), words)


def _further(part: str, place: float) -> str:
    return f'[[{part}]]\nplace = "{place:.6g} m"'


def errors(given: Mapping[str, float], inclination: float = _INCLINATION) -> str:
    """The random errors of the scene ``rocket_rail`` about the ``given`` numbers (SI), with those of the
    angle of the rail as an angle."""
    kind = from_catalogue.KINDS["rocket"]
    usual = read_input(CATALOG / "vary" / f"{kind.scene}.toml").decode("utf-8")
    document = tomlkit.parse(from_catalogue.errors(kind, given) or usual)
    vary = document["vary"]
    table = vary.pop("gravity.z")
    table["mean"], table["sd"] = f"{inclination:g} deg", f"{_ERROR:g} deg"
    vary["gravity.inclination"] = table
    return tomlkit.dumps(document)


def _sources(
    given: Mapping[str, float],
    size: tuple[float, float] | None,
    thrust_curve: Mapping[str, str] | None,
) -> str:
    part = "lugs" if "rod" in given else "buttons"
    found = dict.fromkeys(("payload", part, "rail", "thrust_offset", "gravity"), "assumed")
    found |= _materials(part)
    keys = {
        "mass": ("payload.mass",),
        "clearance": ("contact.clearance",),
        "rail_length": ("rail.end",),
        "rod": ("rail.section",),
    }
    for option in given:
        found |= dict.fromkeys(keys[option], from_catalogue.GIVEN)
    if size is not None:
        found |= dict.fromkeys(
            ("payload.length", "payload.diameter", "payload.size"), from_catalogue.GIVEN
        )
    found["thrust"] = (
        "thrustcurve.org: Cesaroni J360 Skidmark (Pro54-3G), points of the RASP file"
        if thrust_curve is None
        else from_catalogue.GIVEN
    )
    found["thrust.arm"] = "assumed: the nozzle at the tail"
    return ", ".join(f'"{key}" = "{own}"' for key, own in found.items())


def _mounts(spans: list[tuple[float, float]]) -> str:
    """Clamps on these ``spans`` (m)."""
    return ", ".join(f'{{ start = "{start:.4g} m", end = "{end:.4g} m" }}' for start, end in spans)
