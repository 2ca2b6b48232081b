"""A CubeSat of a standard form in its deployer is the payload, pads, rails and spring that were written by
hand."""

import math
import tomllib
from typing import get_args

import pytest
from typer.testing import CliRunner

import tipoff.toml
from tests.exact.spring import end_of_stroke
from tests.lowfi.support import IMMOVABLE
from tipoff import lowfi
from tipoff.scenes import load, parse, provenance
from tipoff.scenes.parts.deployer import Form
from tipoff.scenes.variation import Variations
from tipoff.studies.cli import app

DEPLOYER = tomllib.loads("""
name = "mine"
deployer = { cubesat = "3u" }
payload = { mass = "4 kg" }
contact = { clearance = "0.2 mm" }
friction = { static = 0.2, dynamic = 0.2 }
[thrust]
kind = "springs"
[[thrust.springs]]
preload = "20 N"
rate = "0.04 N/mm"
friction = "0.5 N"
mass = "0.15 kg"
""")
# the same by hand
BY_HAND = tomllib.loads("""
name = "mine"
[payload]
mass = "4 kg"
size = ["340.5 mm", "100 mm", "100 mm"]
inertia = { xx = "0.00666667 kg*m**2", yy = "0.0419801 kg*m**2", zz = "0.0419801 kg*m**2" }
[pads]
stations = ["-162 mm", "-108 mm", "-54 mm", "0 mm", "54 mm", "108 mm", "162 mm"]
corner = ["50 mm", "50 mm"]
length = "16 mm"
width = "8 mm"
inset = "4.25 mm"
relief = "20 um"
[rail]
start = "-170 mm"
end = "174 mm"
leg = "16 mm"
thickness = "4 mm"
mount_width = "4 mm"
mounts = [
  { start = "0 mm", end = "16 mm" },
  { start = "104 mm", end = "120 mm" },
  { start = "216 mm", end = "232 mm" },
  { start = "328 mm", end = "344 mm" },
]
[rail.material]
density = "2700 kg/m**3"
youngs_modulus = "68.9 GPa"
poisson_ratio = 0.33
yield_strength = "276 MPa"
[thrust]
kind = "springs"
arm = "170.25 mm"
[[thrust.springs]]
preload = "20 N"
rate = "0.04 N/mm"
stroke = "330 mm"
friction = "0.5 N"
mass = "0.15 kg"
[contact]
law = "impact"
clearance = "0.2 mm"
exponent = 1.5
stiffness = "70000 N/mm**1.5"
damping = "60 N*s/mm"
damping_depth = "0.3 mm"
interface_stiffness = "1.8e12 N/m**3"
[friction]
static = 0.2
dynamic = 0.2
static_speed = "10 mm/s"
dynamic_speed = "20 mm/s"
""")


def deployer(**tables):
    return parse({**DEPLOYER, **tables})


def test_a_form_is_the_scene_that_was_written_by_hand():
    scene = deployer()
    assert scene.hash == parse(BY_HAND).hash
    assert parse(scene.written_out()).hash == scene.hash
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    assert not {"deployer"} & set(scene.written_out())


def test_what_follows_says_where_from():
    scene = deployer()
    for key in ("payload.size", "pads.3.position"):
        text = provenance.nearest(scene.provenance, key)
        assert text.startswith("CubeSat Design Specification, Rev. 14.1: 100 x 100 x 340.5 mm")
    for key in ("payload.inertia.yy", "rail.end", "friction.static_speed"):
        assert provenance.nearest(scene.provenance, key).startswith("assumed"), key
    assert provenance.nearest(scene.provenance, "payload.mass") is None


@pytest.mark.parametrize(
    "change, moved",
    [
        (
            {"deployer.cubesat": "6u"},
            lambda s: s.payload.size == pytest.approx((0.366, 0.2263, 0.1)),
        ),
        ({"deployer.cubesat": "1u"}, lambda s: s.thrust.springs[0].stroke == pytest.approx(0.103)),
        ({"payload.mass": 6.0}, lambda s: s.payload.inertia.xx == pytest.approx(0.01)),
        (
            {"payload.size": [0.3, 0.1, 0.1]},
            lambda s: (
                s.payload.inertia.yy == pytest.approx(4.0 * (0.3**2 + 0.1**2) / 12.0, rel=1e-5)
            ),
        ),
        ({"rail.leg": 0.02}, lambda s: (s.rail.leg, s.rail.thickness) == (0.02, 0.004)),
        ({"rail.end": 0.2}, lambda s: (s.rail.start, s.rail.end) == (-0.17, 0.2)),
        ({"thrust.springs.0.stroke": 0.3}, lambda s: s.thrust.springs[0].stroke == 0.3),
        ({"contact.clearance": 1e-4}, lambda s: s.contact.gaps()[1] == 1e-4),
        ({"contact": None}, lambda s: s.contact is None),
        (
            {"pads.3.length": 5e-3},
            lambda s: [p.length for p in s.pads[2:5]] == [0.016, 5e-3, 0.016],
        ),
    ],
)
def test_what_a_scene_states_is_kept_and_the_rest_follows(change, moved):
    scene = deployer().replace(change)
    assert moved(scene) and not moved(deployer())
    assert Variations(deployer()).of(change).hash == scene.hash
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    condition = parse({**DEPLOYER, "conditions": {"one": change}}, bare_numbers_are_si=True)
    assert condition.condition("one").hash == scene.hash


def test_pads_of_the_user_are_kept():
    pads = [{**pad, "length": "20 mm"} for pad in deployer().written_out()["pads"]]
    scene = deployer(pads=pads)
    assert {pad.length for pad in scene.pads} == {0.02} and scene.rail == deployer().rail
    assert scene.replace({"pads.0.length": 0.01}).pads[0].length == 0.01


def test_the_command_prints_what_follows(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(tipoff.toml.dumps(DEPLOYER))
    found = CliRunner().invoke(app, ["scenes", "--show", str(path)])
    assert found.exit_code == 0, found.output
    raw = tomllib.loads(found.stdout)
    assert len(raw["pads"]) == 28 and "deployer" not in raw
    path.write_text(found.stdout)
    assert load(path).hash == deployer().hash


@pytest.mark.parametrize("form", get_args(Form))
def test_each_form_leaves_its_deployer(form):
    """Without errors it touches no rail, and leaves at the speed by the energy of the spring. Its first and last
    pads are the feet of the CubeSat. Control: without the mass of the pusher the speed differs."""
    scene = deployer().replace({"deployer.cubesat": form, "platform": IMMOVABLE})
    (spring,) = scene.thrust.springs
    places, half = [pad.position[0] for pad in scene.pads], 0.5 * scene.payload.size[0]
    assert max(places) == pytest.approx(half - 8.25e-3) and min(places) == -max(places)
    assert scene.thrust.arm == half and scene.warnings == []
    run = lowfi.run(scene, "springs")
    assert run.status == "exited"
    masses = (scene.payload.mass, math.inf)
    numbers = (spring.preload, spring.rate, spring.stroke, masses, spring.friction)
    exact = end_of_stroke(*numbers, spring.mass).payload
    assert run.outcome.velocity[0] == pytest.approx(exact, rel=1e-6)
    # Control:
    assert abs(end_of_stroke(*numbers).payload / exact - 1.0) > 0.01
