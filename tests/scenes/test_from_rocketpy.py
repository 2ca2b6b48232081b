"""A flight of RocketPy becomes a scene with its numbers: of flights that are written down here, and of
RocketPy itself where it is installed."""

import json
import math
import os
import subprocess
import sys
import tomllib
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tipoff
import tipoff.toml
from tests.docs import pages
from tipoff import lowfi
from tipoff.mechanics.run_limits import EXIT_WINDOW
from tipoff.results import hand_over
from tipoff.scenes import SceneError, implausible, parse, provenance
from tipoff.scenes.effects.hand_over import standing

# two bodies on one axis: mass (kg), place ahead of the nozzle (m), moments across and along (kg m2)
DRY, PROPELLANT = (16.0, 1.2, 7.0, 0.04), (3.0, 0.4, 0.1, 0.002)
# Cesaroni M1670 as thrustcurve.org has it: s, N
M1670 = [(0.055, 100), (0.092, 1500), (0.1, 2000), (0.15, 2200), (0.2, 1800), (0.5, 1950)]
M1670 += [(1.0, 2034), (1.5, 2000), (2.0, 1900), (2.5, 1760), (2.9, 1700), (3.0, 1650)]
M1670 += [(3.3, 530), (3.4, 350), (3.9, 0)]
HEADING, INCLINATION = 53.0, 84.0


class Points:
    """A function of time as RocketPy has it: a table with straight lines between its points."""

    def __init__(self, *points):
        self.source = np.array(points, dtype=float)

    def __call__(self, time):
        return float(np.interp(time, *self.source.T, left=0.0, right=0.0))

    def get_interpolation_method(self):
        return "linear"


def flight(way=1.0, angle=0.0, **changes):
    """A rocket of two bodies in RocketPy's words, with places along ``way`` = 1 to the nose or -1 to the tail,
    from a datum 0.7 m ahead of the nozzle, and buttons at an ``angle`` (deg)."""
    at = [way * (place - 0.7) for place in (0.0, DRY[1], PROPELLANT[1], 0.3, 2.6)]
    mass, apart = DRY[0] + PROPELLANT[0], DRY[1] - PROPELLANT[1]
    across = (
        DRY[2] + PROPELLANT[2] + PROPELLANT[0] * apart**2
    )  # about the mass centre of the dry one
    moments = {"11": across, "22": across, "33": DRY[3] + PROPELLANT[3], "12": 0, "13": 0, "23": 0}
    turn = Rotation.from_euler("ZXZ", [-HEADING, INCLINATION - 90.0, angle], degrees=True)
    nose = SimpleNamespace()
    button = SimpleNamespace(buttons_distance=0.9, button_height=None)
    rocket = SimpleNamespace(
        coordinate_system_orientation="tail_to_nose" if way > 0.0 else "nose_to_tail",
        total_mass=lambda time: mass,
        center_of_mass=lambda time: (DRY[0] * at[1] + PROPELLANT[0] * at[2]) / mass,
        center_of_dry_mass_position=at[1],
        nozzle_position=at[0],
        radius=0.08,
        rail_buttons=[SimpleNamespace(component=button, position=SimpleNamespace(z=at[3]))],
        nosecones=[nose],
        aerodynamic_surfaces=[SimpleNamespace(component=nose, position=SimpleNamespace(z=at[4]))],
        cm_eccentricity_x=0.0,
        cm_eccentricity_y=0.0,
        thrust_eccentricity_x=0.0,
        thrust_eccentricity_y=0.0,
        motor=SimpleNamespace(
            thrust=Points(*M1670), burn_out_time=3.9, pressure_thrust=lambda pressure: 0.0
        ),
        **{f"I_{pair}": lambda time, value=value: value for pair, value in moments.items()},
    )
    vars(rocket).update(changes)
    return SimpleNamespace(
        name="Test flight",
        rocket=rocket,
        env=SimpleNamespace(elevation=1400.0, pressure=lambda height: 86_000.0),
        rail_length=5.0,
        inclination=INCLINATION,
        heading=HEADING,
        initial_solution=[0.0] * 7 + turn.as_quat(scalar_first=True).tolist() + [0.0] * 3,
    )


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_every_value_of_a_flight_is_in_the_scene_with_its_field(way):
    """The inertia is that of two bodies about their common mass centre, I1 + I2 + m1 m2 / (m1 + m2) d^2.
    Control: about the mass centre without propellant it is larger."""
    scene = tipoff.scene_from_rocketpy(flight(way))
    mass, apart = DRY[0] + PROPELLANT[0], DRY[1] - PROPELLANT[1]
    centre = (DRY[0] * DRY[1] + PROPELLANT[0] * PROPELLANT[1]) / mass
    across = DRY[2] + PROPELLANT[2] + DRY[0] * PROPELLANT[0] / mass * apart**2
    assert scene.payload.mass == pytest.approx(mass)
    assert scene.payload.size == pytest.approx((2.6, 0.16, 0.16))
    inertia = scene.payload.inertia
    assert (inertia.xx, inertia.yy, inertia.zz) == pytest.approx((0.042, across, across), rel=1e-9)
    # Control:
    assert DRY[2] + PROPELLANT[2] + PROPELLANT[0] * apart**2 > 1.03 * inertia.yy
    places = sorted({pad.position[0] for pad in scene.pads})
    assert places == pytest.approx([0.3 - centre, 1.2 - centre])
    assert (scene.rail.start, scene.rail.end) == pytest.approx((-centre, 5.0 - centre))
    assert scene.thrust.arm == pytest.approx(centre) and scene.thrust.reaction == "exhaust"
    assert scene.thrust.requested() == pytest.approx(np.trapezoid(*np.array(M1670).T[::-1]))
    rail = standing(scene.resolved())
    assert (rail.elevation, rail.dry_mass_centre) == pytest.approx((1400.0, DRY[1] - centre))
    assert np.degrees([rail.inclination, rail.heading]) == pytest.approx((INCLINATION, HEADING))
    assert scene.mass_offset is None and scene.thrust_offset is None and rail.assumed == ()
    assert implausible.of_all_conditions(scene) == []
    for key, field in {
        "payload.mass": "total_mass at ignition",
        "payload.inertia.yy": "I_11",
        "payload.mass_centre": "center_of_mass",
        "buttons.1.place": "rail_buttons",
        "rail.end": "rail_length",
        "gravity.inclination": "inclination",
        "thrust": "motor.thrust",
        "hand_over.heading": "heading",
    }.items():
        text = provenance.nearest(scene.provenance, key)
        assert text.startswith("RocketPy: ") and field in text
    for key in ("rail.mounts", "contact.stiffness", "friction", "buttons.0.profile", "pads"):
        assert provenance.nearest(scene.provenance, key).startswith(("assumed", "from")), key


def test_the_scene_is_a_file_too():
    scene = tipoff.scene_from_rocketpy(flight())
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    assert parse(tomllib.loads(tipoff.toml.dumps(scene.written_out()))).hash == scene.hash


@pytest.mark.parametrize("angle", [0.0, 45.0, 130.0, 300.0])
def test_lines_of_thrust_and_mass_are_turned_into_the_axes_of_the_rail(angle):
    """RocketPy turns the rocket by the angle of its buttons about its axis, so that they face the rail. A line
    of thrust towards the sky is along our +Z, and one to the right of the rail, seen along it, along -Y.
    The state that goes back is in the axes of that rocket."""
    rail = Rotation.from_euler("ZXZ", [-HEADING, INCLINATION - 90.0, 0.0], degrees=True)
    body = Rotation.from_euler("ZXZ", [-HEADING, INCLINATION - 90.0, angle], degrees=True)
    up, right = rail.apply([0.0, -1.0, 0.0]), rail.apply([1.0, 0.0, 0.0])
    assert up[2] > 0.0 and abs(right[2]) < 1e-15
    ex, ey, _ = body.inv().apply(2e-3 * up)
    cx, cy, _ = body.inv().apply(1e-3 * right)
    values = {"thrust_eccentricity_x": ex - cx, "thrust_eccentricity_y": ey - cy}
    values |= {"cm_eccentricity_x": cx, "cm_eccentricity_y": cy}
    asked = flight(angle=angle, **values)
    scene = tipoff.scene_from_rocketpy(asked)
    assert scene.thrust_offset.eccentricity.offset() == pytest.approx((0.0, 0.0, 2e-3), abs=1e-12)
    assert scene.mass_offset.eccentricity.offset() == pytest.approx((0.0, -1e-3, 0.0), abs=1e-12)
    at_rest = SimpleNamespace(
        exit_time=0.0,
        exit_position=[0.0] * 3,
        exit_velocity=[0.0] * 3,
        exit_attitude=[0.0] * 3,
        exit_rate=[0.1, 0.2, 0.3],
    )
    found = hand_over.initial_solution(hand_over.at_exit(at_rest), standing(scene.resolved()))
    turned = Rotation.from_quat(found[7:11], scalar_first=True)
    wanted = body * Rotation.from_rotvec(0.5 * EXIT_WINDOW * found[11:])
    assert (turned.inv() * wanted).magnitude() < 1e-9
    spin = turned.apply(found[11:])
    expected = rail.apply([-0.2, -0.3, 0.1])
    np.testing.assert_allclose(spin, expected, atol=1e-4)


def test_a_thrust_that_begins_late_jumps_and_a_pressure_adds_to_it():
    motor = SimpleNamespace(
        thrust=Points((0.1, 500), (1.0, 300)), burn_out_time=1.0, pressure_thrust=lambda p: 20.0
    )
    curve = tipoff.scene_from_rocketpy(flight(motor=motor)).thrust.curve()
    assert curve.time.tolist() == [0.0, 0.1, 0.1, 1.0]
    assert curve.force.tolist() == [0.0, 0.0, 520.0, 320.0]


def test_every_value_that_a_flight_lacks_is_listed():
    wrong = flight(rail_buttons=[], total_mass=lambda time: math.nan, motor=None)
    wrong.inclination = None
    with pytest.raises(SceneError) as caught:
        tipoff.scene_from_rocketpy(wrong)
    keys = {fault.key for fault in caught.value.faults}
    assert {
        "rocket.rail_buttons",
        "rocket.total_mass",
        "rocket.motor.thrust",
        "inclination",
    } <= keys
    with pytest.raises(SceneError, match="17 faults"):
        tipoff.scene_from_rocketpy(object())
    for place, value in ((0, 1.0), (6, 30.0), (7, 0.2)):
        flying = flight()
        flying.initial_solution[place] = value
        with pytest.raises(SceneError, match="without initial_solution"):
            tipoff.scene_from_rocketpy(flying)


# below: RocketPy itself


def calisto(way="tail_to_nose"):
    """RocketPy's first example, of its page First Simulation, with a constant drag."""
    rocketpy = pytest.importorskip("rocketpy", reason="rocketpy is not installed: make peers does")
    sign = 1.0 if way == "tail_to_nose" else -1.0
    motor = rocketpy.SolidMotor(
        thrust_source=[(0.0, 0.0), *M1670],
        burn_time=3.9,
        dry_mass=1.815,
        dry_inertia=(0.125, 0.125, 0.002),
        center_of_dry_mass_position=0.317,
        nozzle_position=0,
        grain_number=5,
        grain_density=1815,
        nozzle_radius=33 / 1000,
        throat_radius=11 / 1000,
        grain_separation=5 / 1000,
        grain_outer_radius=33 / 1000,
        grain_initial_height=120 / 1000,
        grains_center_of_mass_position=0.397,
        grain_initial_inner_radius=15 / 1000,
        interpolation_method="linear",
        coordinate_system_orientation="nozzle_to_combustion_chamber",
    )
    rocket = rocketpy.Rocket(
        radius=0.0635,
        mass=14.426,
        inertia=(6.321, 6.321, 0.034),
        power_off_drag=0.4,
        power_on_drag=0.4,
        center_of_mass_without_motor=0,
        coordinate_system_orientation=way,
    )
    rocket.add_motor(motor, position=-1.255 * sign)
    rocket.set_rail_buttons(
        upper_button_position=0.0818 * sign,
        lower_button_position=-0.6182 * sign,
        angular_position=45,
    )
    rocket.add_nose(length=0.55829, kind="von karman", position=1.278 * sign)
    rocket.add_trapezoidal_fins(
        n=4, root_chord=0.120, tip_chord=0.060, span=0.110, position=-1.04956 * sign
    )
    return rocketpy, rocket


def flown(rocketpy, rocket, **keys):
    environment = rocketpy.Environment(latitude=32.99, longitude=-106.97, elevation=1400)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return rocketpy.Flight(
            rocket=rocket,
            environment=environment,
            rail_length=5.2,
            inclination=85,
            heading=133,
            **({"max_time": 1.0} | keys),
        )


@pytest.mark.parametrize("way", ["tail_to_nose", "nose_to_tail"])
def test_the_scene_leaves_its_rail_as_rocketpy_says(way):
    """RocketPy's rocket is off its rail when the upper button leaves. Our time is its time, and our speed its
    speed, to 1 %: its mass falls by 1 % until then, and ours is that at ignition. Both have no friction.
    Control: the rocket without propellant is faster by more."""
    theirs = flown(*calisto(way))
    scene = tipoff.scene_from_rocketpy(theirs).replace({"friction": None})
    rocket = theirs.rocket
    assert scene.payload.mass == pytest.approx(float(rocket.total_mass(0.0)), rel=1e-9)
    assert abs(scene.pads[0].position[0] - scene.pads[-1].position[0]) == pytest.approx(0.7)
    time, speed = leaving(scene)
    assert time == pytest.approx(theirs.out_of_rail_time, rel=0.01)
    assert speed == pytest.approx(theirs.out_of_rail_velocity, rel=0.01)
    # Control:
    _, faster = leaving(scene.replace({"payload.mass": float(rocket.dry_mass)}))
    assert faster > 1.05 * theirs.out_of_rail_velocity


def leaving(scene):
    """Time (s) and speed (m/s) at which the middle of the upper button passes the end of the rail."""
    run = lowfi.run(scene, "springs")
    way = scene.rail.end - max(pad.position[0] for pad in scene.pads)
    time = float(np.interp(way, run.position[:, 0], run.time))
    return time, float(np.interp(time, run.time, run.velocity[:, 0]))


def test_rocketpy_begins_as_the_scene_stands():
    """Its attitude at ignition is that of our payload at rest on the rail, in the axes of its rocket."""
    theirs = flown(*calisto())
    scene = tipoff.scene_from_rocketpy(theirs)
    at_rest = SimpleNamespace(
        exit_time=0.0,
        **{f"exit_{name}": [0.0] * 3 for name in ("position", "velocity", "attitude", "rate")},
    )
    found = hand_over.initial_solution(hand_over.at_exit(at_rest), standing(scene.resolved()))
    ours, other = (
        Rotation.from_quat(state, scalar_first=True)
        for state in (found[7:11], theirs.solution[0][7:11])
    )
    assert (ours.inv() * other).magnitude() < 1e-9


BEFORE = """
import json, warnings
from tests.scenes.test_from_rocketpy import calisto
warnings.simplefilter("ignore")
rocketpy, rocket = calisto()
environment = rocketpy.Environment(elevation=1400)
"""
AFTER = """
print(json.dumps([
    [without.out_of_rail_velocity, float(run.outcome.exit_velocity[0])],
    [without.apogee, with_.apogee],
]))
"""


def test_the_program_of_the_page_flies_with_and_without_tip_off(tmp_path):
    """The rocket leaves the rail with its lower button faster than with its upper one, and both flights reach
    heights within 5 %."""
    pytest.importorskip("rocketpy", reason="rocketpy is not installed: make peers does")
    (program,) = [
        text for text in pages.of_language("docs/howto/flight.md", "text") if "Flight(" in text
    ]
    program = program.replace("tipoff.run(scene)", 'tipoff.run(scene, "springs")')
    done = subprocess.run(
        [sys.executable, "-c", BEFORE + program + AFTER],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(pages.ROOT), *sys.path])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    speeds, heights = json.loads(done.stdout.splitlines()[-1])
    assert speeds[0] < speeds[1] < 1.15 * speeds[0]
    assert heights[1] == pytest.approx(heights[0], rel=0.05)
