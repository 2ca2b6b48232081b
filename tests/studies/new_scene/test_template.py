"""A scene from a few numbers holds them, is plausible, and its payload leaves the rail and settles."""

import tomllib

import pytest
from typer.testing import CliRunner

import tipoff
from tests.lowfi.support import IMMOVABLE, WEIGHTLESS
from tipoff import lowfi, scenes
from tipoff.results import unfinished
from tipoff.scenes import SceneError, implausible, launch, provenance, uncertainty
from tipoff.studies.cli import app
from tipoff.studies.new_scene import template
from tipoff.studies.new_scene.template import Numbers

LAUNCHERS = {
    "reference": Numbers(),
    "slow": Numbers(mass=12.0, thrust=1500.0),
    "small": Numbers(0.8, (0.10, 0.05, 0.06), 0.10, 0.1e-3, 300.0, 0.010),
    "far slower": Numbers(thrust=60.0),
    "large": Numbers(150.0, (1.2, 0.6, 0.5), 1.0, 0.5e-3, 40_000.0, 0.1),
    "three stations": Numbers(pads=12),
}


CURVE = "time_s,force_N\n0,0\n0.008,1200\n0.012,5900\n0.012,3100\n0.024,0\n"


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(params=LAUNCHERS)
def launcher(request, tmp_path):
    path = tmp_path / f"{request.param.split()[0]}.toml"
    path.write_text(template.text("new", LAUNCHERS[request.param]))
    return LAUNCHERS[request.param], scenes.load(path)


def test_it_holds_the_numbers_and_is_plausible(launcher):
    numbers, scene = launcher
    assert scene.payload.mass == numbers.mass
    assert scene.payload.size == pytest.approx(numbers.size, rel=1e-5)
    assert scene.contact.clearance == pytest.approx(numbers.clearance, rel=1e-5)
    assert scene.thrust.peak == numbers.thrust
    assert launch.of_scene(scene).way == pytest.approx(numbers.rail_length, rel=1e-5)
    assert implausible.of_all_conditions(scene) == []


@pytest.mark.parametrize("name", LAUNCHERS)
def test_it_runs_to_settled_rates_without_a_duration(name, tmp_path):
    path = tmp_path / "new.toml"
    path.write_text(template.text("new", LAUNCHERS[name]))
    assert "duration" not in tomllib.loads(path.read_text())
    run = lowfi.run(scenes.load(path), "springs")
    assert run.status == "exited", unfinished.advice(scenes.load(path), run)


def test_a_scene_refers_to_the_curve_of_its_thrust(tmp_path, monkeypatch):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / 'my "firing".csv').write_text(CURVE)
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "scenes" / "measured.toml"
    file.parent.mkdir()
    found = call("new", file, "--thrust-curve", 'data/my "firing".csv')
    assert found.exit_code == 0, found.stderr
    monkeypatch.chdir("/")
    scene = scenes.load(file)
    assert scene.thrust.requested() == pytest.approx(0.5 * (1.2 * 8 + 7.1 * 4 + 3.1 * 12))
    assert tomllib.loads(file.read_text())["thrust"]["file"] == '../data/my "firing".csv'
    assert implausible.of_all_conditions(scene) == []
    run = lowfi.run(scene.replace({"gravity": WEIGHTLESS}), "springs")  # no kernel of its own
    assert run.status == "exited", unfinished.advice(scene, run)


@pytest.mark.parametrize(
    "curve, others, words",
    [
        ("time_s,force_N\n0,0\n1,x\n0.5,1 N\n", [], ["force_N: 'x' in line 3", "'1 N' in line 4"]),
        ("t,F\n0,0\n", [], ["as in time_s,force_N", "header 't, F'"]),
        ("time_s,force_N\n0,0\n1,-5\n", [], ["an impulse above zero", "-2.5 N s"]),
        (
            None,
            ["--mass", "9 m", "--pads", "6"],
            ["3 faults", "No such file", "--mass", "multiple of 4"],
        ),
        (CURVE, ["--thrust", "4 kN", "--burn-time", "9 ms"], ["2 faults", "none beside"]),
    ],
)
def test_faults_of_a_curve_are_listed_before_anything_is_written(
    curve, others, words, tmp_path, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)
    if curve is not None:
        (tmp_path / "firing.csv").write_text(curve)
    found = call("new", "mine.toml", "--thrust-curve", "firing.csv", *others)
    assert found.exit_code == 2 and not (tmp_path / "mine.toml").exists()
    assert all(word in found.stderr for word in words), found.stderr


def _scene(numbers, tmp_path):
    path = tmp_path / "pads.toml"
    path.write_text(template.text("pads", numbers))
    return scenes.load(path)


def test_pads_stand_at_their_stations(tmp_path):
    places = {
        count: sorted({pad.position[0] for pad in _scene(Numbers(pads=count), tmp_path).pads})
        for count in (4, 8, 12)
    }
    assert places == {4: [0.0], 8: [-0.08, 0.08], 12: [-0.08, 0.0, 0.08]}
    assert [len(_scene(Numbers(pads=count), tmp_path).pads) for count in (4, 8, 12)] == [4, 8, 12]


def test_four_long_pads_reach_as_far_as_eight_and_hold_the_payload(tmp_path):
    """The payload turns by less than the clearance allows a body between the ends of its pads.
    Control: pads as short as those of two stations let it turn by more."""
    four, eight = (_scene(Numbers(pads=count), tmp_path) for count in (4, 8))
    assert launch.of_scene(four).way == pytest.approx(launch.of_scene(eight).way, rel=1e-9)
    assert implausible.of_all_conditions(four) == []
    held = 2.0 * four.contact.clearance / four.pads[0].length
    tilted = four.replace({"thrust_offset.misalignment.axial": "2 deg"})
    short = tilted.replace({f"pads.{pad}.length": 0.016 for pad in range(4)})

    def turned(scene):
        scene = scene.replace({"platform": IMMOVABLE})  # a kernel that is compiled anyway
        run = tipoff.run(scene, compliance=tipoff.compliance(scene, 16e-3), modes=0)
        on_rail = run.position[:, 0] < 0.04  # whole pads
        return abs(2.0 * run.quaternion[on_rail, 1:]).max()

    assert turned(tilted) < 1.1 * held < turned(short)


@pytest.mark.parametrize("pads, words", [(0, "4, 8, 12"), (6, "4, 8, 12"), (48, "at most 44")])
def test_pads_that_the_rails_cannot_hold_are_refused(pads, words, tmp_path):
    template.text("bad", Numbers(pads=44))
    with pytest.raises(SceneError, match=f"--pads.*{words}"):
        template.text("bad", Numbers(pads=pads))
    found = call("new", tmp_path / "mine.toml", "--pads", pads)
    assert found.exit_code == 2 and words in found.stderr


def test_every_number_that_makes_no_launcher_is_refused():
    with pytest.raises(SceneError) as caught:
        template.text("bad", Numbers(mass=0.0, size=(1.0, 0.1, -1.0), clearance=0.0))
    assert [fault.source for fault in caught.value.faults] == ["--mass", "--size", "--clearance"]
    with pytest.raises(SceneError, match="--clearance"):
        template.text("bad", Numbers(clearance=0.02))


def test_the_command_writes_a_file_once_and_says_what_comes_next(tmp_path):
    file = tmp_path / "mine.toml"
    found = call("new", file, "--mass", "12 kg", "--size", "0.4 m, 20 cm, 200 mm")
    assert found.exit_code == 0 and f"tipoff run --scene {file}" in found.stdout
    assert scenes.load(file).payload.size == (0.4, 0.2, 0.2)
    text = file.read_text()
    again = call("new", file)
    assert again.exit_code == 2 and "not there yet" in again.stderr and file.read_text() == text


def test_the_command_lists_every_fault(tmp_path):
    file = tmp_path / "mine.toml"
    found = call("new", file, "--mass", "12 m", "--size", "1 m", "--thrust", "-4 kN")
    assert found.exit_code == 2 and not file.exists()
    assert all(option in found.stderr for option in ("--mass", "--size", "--thrust", "3 faults"))


def test_a_deployer_has_the_given_numbers_and_the_rest_of_the_catalogue(tmp_path, monkeypatch):
    """In 34 lines or fewer. Mass, clearance and force are those given; the inertia is that of a homogeneous box; all
    other values are those of ``cubesat_3u``. Control: without numbers contact and spring are too."""
    monkeypatch.chdir(tmp_path)
    asked = ("--mass", "4.5 kg", "--clearance", "0.3 mm", "--thrust", "25 N")
    made = call("new", "own.toml", "--deployer", "3u", *asked)
    assert made.exit_code == 0, made.output
    scene, own = scenes.load("own.toml"), scenes.load("cubesat_3u")
    assert (scene.payload.mass, scene.thrust.springs[0].preload) == (4.5, 25.0)
    assert scene.contact.clearance == pytest.approx(0.3e-3, rel=1e-12)
    assert scene.payload.inertia.xx == pytest.approx(4.5 * 0.02 / 12.0, rel=1e-5)
    assert scene.provenance["payload.mass"] == "given to tipoff new"
    assert implausible.of_all_conditions(scene) == []
    names = ("pads", "rail", "platform", "friction", "mass_offset")
    assert all(getattr(scene, name) == getattr(own, name) for name in names)
    text = (tmp_path / "own.toml").read_text()
    assert len(text.splitlines()) <= 34 and "--scene own.toml --limit" in text
    # Control:
    assert call("new", "same.toml", "--deployer", "3u").exit_code == 0
    same = scenes.load("same.toml")
    assert all(getattr(same, name) == getattr(own, name) for name in (*names, "contact", "thrust"))
    assert (same.payload.mass, same.payload.size) == (own.payload.mass, own.payload.size)
    assert same.studies.errors == "cubesat_3u" and not (tmp_path / "same_errors.toml").exists()
    assert scene.contact != own.contact and scene.thrust != own.thrust


@pytest.mark.parametrize(
    "size, options",
    [("3.7 m x 0.15 m", ("--rocket",)), ("1.6 m", ("--rocket",)), ("0.4 m x 0.2 m x 0.2 m", ())],
)
def test_sides_are_separated_by_commas(tmp_path, monkeypatch, size, options):
    monkeypatch.chdir(tmp_path)
    found = call("new", "own.toml", *options, "--size", size)
    assert found.exit_code == 2 and "for example" in found.stderr
    assert '"1.6 m, 80 mm"' in found.stderr if options else "350 mm, 200 mm" in found.stderr


def test_a_refused_scene_leaves_no_file_beside_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call("new", "own.toml", "--rocket", "--rail-length", "10 mm").exit_code == 2
    assert list(tmp_path.iterdir()) == []
    # Control: the same with a rail that the buttons are on.
    assert call("new", "own.toml", "--rocket", "--rail-length", "3 m").exit_code == 0
    beside = {path.name for path in tmp_path.iterdir()}
    assert "own_errors.toml" in beside and len(beside) > 2


def test_files_of_another_scene_are_neither_taken_nor_replaced(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call("new", "own.toml", "--deployer", "3u", "--mass", "4.5 kg").exit_code == 0
    errors = tmp_path / "own_errors.toml"
    (tmp_path / "own.toml").unlink()
    before = errors.read_text()
    refused = call("new", "own.toml", "--deployer", "3u", "--mass", "3 kg")
    assert refused.exit_code == 2 and "own_errors.toml" in refused.output
    assert errors.read_text() == before and not (tmp_path / "own.toml").exists()
    # Control: the same numbers give the same file, which may stay.
    assert call("new", "own.toml", "--deployer", "3u", "--mass", "4.5 kg").exit_code == 0
    assert errors.read_text() == before


# Typed here a second time on purpose: CubeSat Design Specification, Rev. 14.1; 16U is assumed. mm, kg
CUBESATS = {
    "1u": (113.5, 100.0, 100.0, 2.0),
    "1.5u": (170.2, 100.0, 100.0, 3.0),
    "2u": (227.0, 100.0, 100.0, 4.0),
    "6u": (366.0, 226.3, 100.0, 12.0),
    "12u": (366.0, 226.3, 226.3, 24.0),
    "16u": (454.0, 226.3, 226.3, 32.0),
}


@pytest.mark.parametrize("size", CUBESATS)
def test_a_deployer_of_each_size_fits_its_cubesat(size, tmp_path, monkeypatch):
    """Its pads stand on the four edges of the box, on the rails, and it leaves at the speed of the 3U, as two
    thirds of the largest mass. Errors are about its own numbers."""
    monkeypatch.chdir(tmp_path)
    made = call("new", "own.toml", "--deployer", size)
    assert made.exit_code == 0, made.output
    scene, usual = scenes.load("own.toml"), scenes.load("cubesat_3u")
    *sides, most = CUBESATS[size]
    assert scene.payload.size == pytest.approx([1e-3 * side for side in sides])
    assert scene.payload.mass == pytest.approx(2.0 / 3.0 * most, rel=1e-5)
    places = [pad.position for pad in scene.pads]
    assert [abs(place[1]) for place in places] == pytest.approx(len(places) * [0.5e-3 * sides[1]])
    assert [abs(place[2]) for place in places] == pytest.approx(len(places) * [0.5e-3 * sides[2]])
    assert min(place[0] for place in places) - 8e-3 >= scene.rail.start
    assert max(place[0] for place in places) + 8e-3 <= scene.rail.end
    assert scene.warnings == [] and implausible.of_all_conditions(scene) == []

    def speed_squared(one):
        spring = one.thrust.springs[0]
        work = spring.preload * spring.stroke - 0.5 * spring.rate * spring.stroke**2
        return 2.0 * work / one.payload.mass

    assert speed_squared(scene) == pytest.approx(speed_squared(usual), rel=1e-4)
    assert provenance.nearest(scene.provenance, "payload.size").startswith(
        "assumed" if size == "16u" else "CubeSat Design Specification"
    )
    vary = uncertainty.of_scene(scene).vary
    assert not uncertainty.far_from_scene(uncertainty.of_scene(scene), scene), vary


@pytest.mark.parametrize("options", [(), ("--rocket",)])
def test_a_curve_in_the_time_of_a_clock_gets_its_ignition(tmp_path, monkeypatch, options):
    monkeypatch.chdir(tmp_path)
    rows = "1700000000000,0\n1700000000050,400\n1700000002500,380\n1700000002600,0\n"
    (tmp_path / "motor.csv").write_text(f"timestamp_ms,thrust_N\n{rows}")
    made = call("new", "own.toml", *options, "--thrust-curve", "motor.csv")
    assert made.exit_code == 0, made.output
    assert (
        tomllib.loads((tmp_path / "own.toml").read_text())["thrust"]["ignition"] == "1700000000 s"
    )
    assert scenes.load("own.toml").thrust.curve().time == pytest.approx([0.0, 0.05, 2.5, 2.6])


def test_numbers_that_a_deployer_has_not_are_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = call("new", "own.toml", "--deployer", "3u", "--pads", "4", "--mass", "-1 kg")
    assert made.exit_code == 2 and not (tmp_path / "own.toml").exists()
    assert "--mass" in made.stderr
    made = call("new", "own.toml", "--deployer", "3u", "--pads", "4", "--burn-time", "1 s")
    assert made.exit_code == 2 and "--pads" in made.stderr and "--burn-time" in made.stderr
