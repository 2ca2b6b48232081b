"""A launch as RocketPy simulated it: an object of its class ``Flight`` (version 1.13), of which only
public names are read. RocketPy itself is not imported.

Body axes here are X along the rail to the nose, Z from the rail to the rocket, and Y across. They follow
from the attitude at ignition. Places are distances ahead of the nozzle, which RocketPy sets on the rear
end of the rail. RocketPy counts inertia about the mass centre without propellant; with the mass M and
the distance d of the mass centre from it, the moments about the mass centre are::

    I_xx = I_33        I_yy, I_zz = I_11, I_22 - M d^2
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

_KNOTS = 400  # of a thrust that is no table of straight lines
_UPRIGHT = 1e-3  # rad, largest angle between rocket and rail at ignition
_READING = (AttributeError, IndexError, KeyError, TypeError, ValueError)


class Launch(NamedTuple):
    """A rocket on its rail at ignition, in SI and radians; ``sources`` names the field of each value."""

    name: str
    mass: float
    mass_centre: float  # ahead of the nozzle
    dry_mass_centre: float  # ahead of the mass centre
    inertia: np.ndarray  # (3,3) about the mass centre, in the axes of the module
    diameter: float
    length: float | None  # from the nozzle to the tip of the nose
    buttons: tuple[float, ...]  # rear first, ahead of the nozzle
    button_height: float | None
    rail_length: float
    inclination: float
    heading: float
    elevation: float  # of the environment
    angular_position: float  # of the buttons about the rocket
    mass_line: tuple[float, float]  # Y and Z of the mass centre from the axis
    thrust_line: tuple[float, float]  # Y and Z of the line of the thrust from the axis
    thrust: np.ndarray  # (n,2) time and force
    sources: dict[str, str]


class UnreadableFlight(ValueError):
    """A flight without values that a launch needs; ``faults`` has (key, given, expected) of each."""

    def __init__(self, faults: list[tuple[str, str, str]]):
        self.faults = faults
        super().__init__("; ".join(f"{key}: {expected}" for key, _, expected in faults))


def read_flight(flight: Any) -> Launch:
    """The launch of a ``flight`` of RocketPy. Raises UnreadableFlight, every missing value listed."""
    faults: list[tuple[str, str, str]] = []
    found = {}
    for name, (key, expected, make) in _VALUES.items():
        try:
            found[name] = make(flight)
            if not np.isfinite(found[name]).all():
                faults.append((key, f"{found[name]}", expected))
        except _READING:
            faults.append((key, "nothing", expected))
    if not faults and (fault := _not_on_the_rail(found)):
        faults.append(fault)
    if faults:
        raise UnreadableFlight(faults)
    ahead, mass = found["ahead"], float(found["mass"])
    centre = ahead * (found["mass_centre"] - found["nozzle"])
    dry = ahead * (found["dry_mass_centre"] - found["nozzle"]) - centre
    axes = _axes(found)
    of_dry = found["inertia"] - mass * dry**2 * np.diag([1.0, 1.0, 0.0])
    mass_line = np.array([*found["mass_line"], 0.0])
    lower = ahead * (found["lower"] - found["nozzle"])
    return Launch(
        name=str(getattr(flight, "name", "")),
        mass=mass,
        mass_centre=centre,
        dry_mass_centre=dry,
        inertia=axes @ of_dry @ axes.T,
        diameter=2.0 * found["radius"],
        length=_length(flight, ahead, found["nozzle"]),
        buttons=(lower, lower + found["apart"]),
        button_height=getattr(_buttons(flight).component, "button_height", None),
        rail_length=found["rail_length"],
        inclination=math.radians(found["inclination"]),
        heading=math.radians(found["heading"]),
        elevation=found["elevation"],
        angular_position=math.atan2(-axes[2, 0], -axes[2, 1]),
        mass_line=_across(axes, mass_line),
        thrust_line=_across(axes, mass_line + np.array([*found["thrust_line"], 0.0])),
        thrust=found["thrust"],
        sources=_SOURCES,
    )


def _buttons(flight: Any) -> Any:
    return flight.rocket.rail_buttons[0]


def _ahead(flight: Any) -> float:
    """Sign of RocketPy's coordinate towards the nose."""
    return {"tail_to_nose": 1.0, "nose_to_tail": -1.0}[flight.rocket.coordinate_system_orientation]


def _inertia(flight: Any) -> np.ndarray:
    """(3,3) about the mass centre without propellant, at ignition."""
    rocket = flight.rocket
    xx, yy, zz, xy, xz, yz = (
        float(getattr(rocket, f"I_{pair}")(0.0)) for pair in ("11", "22", "33", "12", "13", "23")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _thrust(flight: Any) -> np.ndarray:
    """(n,2) time and net force at the height of the rail, as RocketPy has it: never negative. A table that
    begins late begins with a jump."""
    motor = flight.rocket.motor
    source, end = motor.thrust.source, float(motor.burn_out_time)
    begin, times = 0.0, np.zeros(1)
    if not callable(source):
        times = np.unique(np.asarray(source, dtype=float)[:, 0])
        begin = max(float(times[0]), 0.0)
    if callable(source) or motor.thrust.get_interpolation_method() != "linear":
        times = np.union1d(times, np.linspace(begin, end, _KNOTS))
    times = np.union1d(times[(times > begin) & (times < end)], [begin, end])
    added = motor.pressure_thrust(flight.env.pressure(flight.env.elevation))
    points = [[time, max(float(motor.thrust(time)) + added, 0.0)] for time in times]
    return np.array(points if begin == 0.0 else [[0.0, 0.0], [begin, 0.0], *points])


_VALUES: dict[str, tuple[str, str, Callable[[Any], Any]]] = {
    "ahead": ("rocket.coordinate_system_orientation", "tail_to_nose or nose_to_tail", _ahead),
    "mass": ("rocket.total_mass", "a mass over time", lambda f: float(f.rocket.total_mass(0.0))),
    "mass_centre": (
        "rocket.center_of_mass",
        "a place over time",
        lambda f: float(f.rocket.center_of_mass(0.0)),
    ),
    "dry_mass_centre": (
        "rocket.center_of_dry_mass_position",
        "a place",
        lambda f: float(f.rocket.center_of_dry_mass_position),
    ),
    "nozzle": (
        "rocket.nozzle_position",
        "a place: rocket.add_motor",
        lambda f: float(f.rocket.nozzle_position),
    ),
    "inertia": ("rocket.I_11", "moments of inertia over time, I_11 to I_33", _inertia),
    "radius": ("rocket.radius", "a radius", lambda f: float(f.rocket.radius)),
    "lower": (
        "rocket.rail_buttons",
        "two buttons: rocket.set_rail_buttons",
        lambda f: float(_buttons(f).position.z),
    ),
    "apart": (
        "rocket.rail_buttons[0].component.buttons_distance",
        "the distance of two buttons",
        lambda f: float(_buttons(f).component.buttons_distance),
    ),
    "mass_line": (
        "rocket.cm_eccentricity_x",
        "a distance, and one along y",
        lambda f: [float(f.rocket.cm_eccentricity_x), float(f.rocket.cm_eccentricity_y)],
    ),
    "thrust_line": (
        "rocket.thrust_eccentricity_x",
        "a distance, and one along y",
        lambda f: [float(f.rocket.thrust_eccentricity_x), float(f.rocket.thrust_eccentricity_y)],
    ),
    "thrust": ("rocket.motor.thrust", "a thrust over time", _thrust),
    "rail_length": ("rail_length", "a length", lambda f: float(f.rail_length)),
    "inclination": ("inclination", "an angle", lambda f: float(f.inclination)),
    "heading": ("heading", "an angle", lambda f: float(f.heading)),
    "elevation": ("env.elevation", "a height", lambda f: float(f.env.elevation)),
    "state": (
        "initial_solution",
        "a state of 14 numbers",
        lambda f: np.array([float(value) for value in f.initial_solution]),
    ),
}
_SOURCES = {
    "payload.mass": "rocket.total_mass at ignition, with propellant",
    "payload.length": "rocket.nosecones, position of the tip, from rocket.nozzle_position",
    "payload.diameter": "rocket.radius",
    "payload.mass_centre": "rocket.center_of_mass at ignition, from rocket.nozzle_position",
    "payload.inertia": "rocket.I_11 to I_33 at ignition, about the mass centre with propellant",
    "buttons.0.place": "rocket.rail_buttons, lower button",
    "buttons.1.place": "rocket.rail_buttons, upper button",
    "buttons.0.flange_height": "rocket.rail_buttons, button_height",
    "rail.start": "rocket.nozzle_position: RocketPy sets the nozzle on the end of the rail",
    "rail.end": "rail_length",
    "gravity.inclination": "inclination",
    "hand_over.heading": "heading",
    "hand_over.elevation": "env.elevation",
    "hand_over.dry_mass_centre": "rocket.center_of_dry_mass_position, from rocket.center_of_mass at ignition",
    "hand_over.angular_position": "attitude at ignition, of rocket.rail_buttons, angular_position",
    "thrust": "rocket.motor.thrust, with pressure_thrust at env.elevation",
    "thrust.arm": "rocket.nozzle_position",
    "mass_offset": "rocket.cm_eccentricity_x and _y",
    "thrust_offset.eccentricity": "rocket.thrust_eccentricity_x and _y, from rocket.cm_eccentricity_x and _y",
}


def _rotation(found: dict) -> np.ndarray:
    """(3,3) from RocketPy's body axes at ignition to East, North and up."""
    w, x, y, z = found["state"][7:11]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _rail(found: dict) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (3,) along the rail and to its upper side, in East, North and up."""
    angles = np.radians([found["inclination"], found["heading"]])
    (ci, ch), (si, sh) = np.cos(angles), np.sin(angles)
    return np.array([sh * ci, ch * ci, si]), np.array([-sh * si, -ch * si, ci])


def _axes(found: dict) -> np.ndarray:
    """(3,3) rows: our X, Y, Z in RocketPy's body axes."""
    _, upper = _rail(found)
    up = _rotation(found).T @ upper
    along = np.array([0.0, 0.0, 1.0])
    up = (up - (up @ along) * along) / np.linalg.norm(up[:2])
    return np.array([along, np.cross(up, along), up])


def _not_on_the_rail(found: dict) -> tuple[str, str, str] | None:
    state, (rail, _) = found["state"], _rail(found)
    expected = "a flight that begins at rest on its rail, without initial_solution"
    if state.shape != (14,) or state[0] != 0.0 or state[4:7].any() or state[11:].any():
        return "initial_solution", "a state in flight", expected
    tilt = float(np.linalg.norm(np.cross(_rotation(found)[:, 2], rail)))
    if tilt > _UPRIGHT:
        return "initial_solution", f"a rocket {math.degrees(tilt):.3g} deg off its rail", expected
    return None


def _across(axes: np.ndarray, line: np.ndarray) -> tuple[float, float]:
    y, z = (axes @ line)[1:]
    return float(y), float(z)


def _length(flight: Any, ahead: float, nozzle: float) -> float | None:
    """From the nozzle to the foremost tip of a nose cone; None without one."""
    try:
        noses = list(flight.rocket.nosecones)
        tips = [
            ahead * (float(surface.position.z) - nozzle)
            for surface in flight.rocket.aerodynamic_surfaces
            if any(surface.component is nose for nose in noses)
        ]
    except _READING:
        return None
    return max((tip for tip in tips if tip > 0.0), default=None)
