"""A scene from a few numbers holds them, is plausible, and its payload leaves the rail and settles."""

import math

import pytest
from typer.testing import CliRunner

from tipoff import lowfi, scenes
from tipoff.mechanics import unfinished
from tipoff.scenes import SceneError, plausibility
from tipoff.studies.cli import app
from tipoff.studies.new_scene import template
from tipoff.studies.new_scene.template import Numbers

LAUNCHERS = {
    "reference": Numbers(),
    "slow": Numbers(mass=12.0, thrust=1500.0),
    "small": Numbers(0.8, (0.10, 0.05, 0.06), 0.10, 0.1e-3, 300.0, 0.010),
    "large": Numbers(150.0, (1.2, 0.6, 0.5), 1.0, 0.5e-3, 40_000.0, 0.1),
}


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(params=LAUNCHERS)
def launcher(request, tmp_path):
    path = tmp_path / f"{request.param}.toml"
    path.write_text(template.text(request.param, LAUNCHERS[request.param]))
    return LAUNCHERS[request.param], scenes.load(path)


def test_it_holds_the_numbers_and_is_plausible(launcher):
    numbers, scene = launcher
    assert scene.payload.mass == numbers.mass
    assert scene.payload.size == pytest.approx(numbers.size, rel=1e-5)
    assert scene.contact.clearance == pytest.approx(numbers.clearance, rel=1e-5)
    assert scene.thrust.peak == numbers.thrust
    assert unfinished.way_to_exit(scene) == pytest.approx(numbers.rail_length, rel=1e-5)
    assert plausibility.of_all_conditions(scene) == []


@pytest.mark.parametrize("name", LAUNCHERS)
def test_it_runs_to_settled_rates_within_its_duration(name, tmp_path):
    path = tmp_path / f"{name}.toml"
    path.write_text(template.text(name, LAUNCHERS[name]))
    run = lowfi.run(scenes.load(path), "springs")
    assert run.status == "exited", unfinished.advice(scenes.load(path), run)


def test_the_duration_is_that_of_the_pulse_alone():
    """A payload far slower than its pulse coasts at impulse / mass."""
    numbers = Numbers(mass=100.0, thrust=100.0, rail_length=1.0)
    # the pulse begins three widths before its peak
    impulse = 100.0 * 0.004 * math.sqrt(math.pi / 2.0) * (1.0 + math.erf(3.0 / math.sqrt(2.0)))
    coasting = numbers.rail_length / (impulse / numbers.mass)  # after the middle of the pulse
    expected = 1.25 * (coasting + 0.012 + 0.003)
    assert template.duration(numbers) == pytest.approx(expected, rel=1e-5)


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
