"""Programs and commands of the documentation, run on the small scene and with few cases. The
programs of README and of the tutorial on both models run in ``test_installed``."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import tipoff
from tests.docs import pages
from tests.formats.curves import adams_files, dyna_files
from tests.studies.measured import launches
from tests.studies.new_scene.test_openrocket import DESIGN, table
from tipoff.kernels.rotation import matrices
from tipoff.studies import measured
from tipoff.studies.cli import app

IN_A_WHEEL = ("README.md", "docs/tutorials/surrogate_and_reference.md")
PROGRAMS = [
    page for page in pages.PAGES if pages.of_language(page, "python") and page not in IN_A_WHEEL
]
# Commands that are not run here, each by what it begins with, and why.
LEFT_OUT = {
    ("scenes", "--show"): "its output stands in the test of commands",
    ("cost",): "minutes: tests/studies/cost",
    ("report",): "every stage: tests/studies/test_pipeline.py",
    ("sensitivity",): "20,480 cases: tests/studies/sensitivity",
    ("limits",): "searches of minutes: tests/studies/limits",
    ("view",): "tests/studies/view",
    ("convergence",): "minutes: tests/studies/convergence",
    ("compare",): "tests/studies/agreement and blind",
    ("--install-completion",): "it changes the shell of the user",
}
SCHEDULER, ACCURACY, FITTED = "--scheduler", "--accuracy", "--calibration"
FEWEST = "400"
COMMANDS = sorted({tuple(words) for page in pages.PAGES for words in pages.tipoff(page) if words})


def _is_run(words: tuple[str, ...]) -> bool:
    apart = {SCHEDULER, ACCURACY, FITTED, "--help"} & set(words)  # machines, or results of others
    return not apart and not any(words[: len(left)] == left for left in LEFT_OUT)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with every file that a command of the documentation names."""
    place = tmp_path_factory.mktemp("reader")
    # It extends the small scene, which states coarse elements. The thrust of README is for longer
    # rails.
    (launcher,) = (tomllib.loads(text) for text in pages.of_language("README.md", "toml"))
    conditions = "".join(
        f"[conditions.{name}]\n" + "".join(f'"{key}" = "{value}"\n' for key, value in table.items())
        for name, table in launcher["conditions"].items()
    )
    small = 'extends = "tiny"\nname = "tiny"\n'
    (place / "my_launcher.toml").write_text(small + conditions)
    (place / "my_deployer.toml").write_text(small)
    (place / "my_rocket.toml").write_text(small + '[gravity]\nx = "-9.80665 m/s**2"\n')
    errors = next(
        text for text in pages.of_language("docs/tutorials/tolerances.md", "toml") if "vary" in text
    )
    # The balance of a deployer is that of a spring, which the small scene has not.
    for name in ("my_errors.toml", "my_tolerances.toml", "my_balance.toml", "my_launch.toml"):
        (place / name).write_text(errors)
    key = "thrust_offset.misalignment.axial"
    (place / "cases.csv").write_text(f"{key}\ndeg\n0.1\n0.2\n")
    curve = next(
        text
        for text in pages.of_language("docs/howto/thrust_from_csv.md", "text")
        if "time_s" in text
    )
    (place / "thrust.csv").write_text(curve)
    (place / "design.ork").write_text(DESIGN)
    (place / "simulation.csv").write_text(table("imperial"), encoding="utf-8")
    logs = Path(measured.__file__).parent / "logs"
    for number in (0, 1):
        shutil.copy(logs / f"simulated{number}.csv", place)
        text = (logs / f"simulated{number}.toml").read_text()
        (place / f"test{number + 1}.toml").write_text(text)
    _write_launch(place)
    _write_codes(place)
    for name in ("phi15", "phi60"):
        _write_curve(place / f"test{name.removeprefix('phi')}.csv", name)
    return place


def _write_launch(place: Path) -> None:
    """A launch of ``my_rocket.toml`` with the sheet of the page."""
    blocks = pages.of_language("docs/howto/measured.md", "text")
    (sheet,) = (text for text in blocks if "[launch]" in text)
    # the small scene pushes harder than a motor
    (place / "flight.toml").write_text(sheet.replace("300 m/s**2", "30000 m/s**2"))
    scene = tipoff.load(place / "my_rocket.toml")
    errors = launches.drawn(np.random.default_rng(1))
    log = launches.log(
        tipoff.run(scene, "springs"), np.array([scene.gravity.x, 0.0, 0.0]), errors, 1
    )
    (place / "flight.csv").write_text(launches.text(launches.table(log)))


def _write_curve(file: Path, condition: str) -> None:
    run = tipoff.run(tipoff.load("tiny").condition(condition))
    lines = ["time [s],velocity_x [m/s],rate_x [rad/s],rate_y [rad/s],rate_z [rad/s]"]
    for time, velocity, rate in zip(run.time, run.velocity, run.rate):
        lines.append(",".join(repr(float(value)) for value in (time, velocity[0], *rate)))
    file.write_text("\n".join(lines) + "\n")


def _write_codes(place: Path) -> None:
    """Files of other codes with a run of the small scene."""
    scene = tipoff.load("tiny").condition("phi15")
    runs = {"compliant": tipoff.run(scene), "springs": tipoff.run(scene, "springs")}
    for name, run in runs.items():
        run.to_csv(place / f"{name}.csv")
    run = runs["compliant"]
    rate = np.einsum("nij,nj->ni", matrices(run.quaternion), run.rate)  # in scene axes
    states = [*zip(1e3 * run.time, run.velocity, 1e-3 * rate)]
    (place / "rbdout").write_text(dyna_files.rbdout(states))
    (place / "binout0000").write_bytes(dyna_files.rigid_body(states).content)
    rows = np.column_stack([run.time, 1e3 * run.velocity[:, 0], np.degrees(run.rate)])
    lines = [
        "Plot_1",
        "Time\tVX\tWX\tWY\tWZ",
        *("\t".join(map(repr, row)) for row in rows.tolist()),
    ]
    (place / "adams.tab").write_text("\n".join(lines))
    motion = [(row[0], f"0 {' '.join(map(repr, row[1:]))}") for row in rows.tolist()]
    (place / "run.res").write_text(adams_files.of_payload(motion))


def _small(words: tuple[str, ...]) -> list[str]:
    """The same command on the small scene, with few cases."""
    found = [*words]
    if "--cases" in found:
        found[found.index("--cases") + 1] = FEWEST
    elif words[0] in ("ensemble", "flight", "measured"):
        found += ["--cases", FEWEST] if "--table" not in found else []
    if "--case" in found:
        found[found.index("--case") + 1] = "7"
    if "--settled-from" in found:
        at = found.index("--settled-from")
        del found[at : at + 2]  # the curves here end with the settled window
    if "--scene" not in found and words[0] not in ("scenes", "doctor", "bench", "new"):
        found += ["--scene", "tiny"]
    return found


@pytest.mark.slow
@pytest.mark.parametrize("words", [words for words in COMMANDS if _is_run(words)], ids=" ".join)
def test_a_command_runs(words, folder, monkeypatch, tmp_path):
    monkeypatch.chdir(folder)
    if words[0] == "new":  # its file must not be there yet
        for name in ("thrust.csv", "design.ork", "simulation.csv"):
            shutil.copy(name, tmp_path)
        monkeypatch.chdir(tmp_path)
    said = CliRunner().invoke(app, _small(words))
    assert said.exit_code == 0, said.output


def _python(folder: Path, *arguments: str) -> str:
    said = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(pages.ROOT), "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=540,
    )
    assert said.returncode == 0, said.stdout + said.stderr
    return said.stdout


@pytest.mark.slow
@pytest.mark.parametrize("page", PROGRAMS)
def test_a_program_runs(page, tmp_path):
    text = "\n".join(pages.of_language(page, "python"))
    before = "" if text.startswith("import tipoff") else _BEFORE
    _python(tmp_path, "-c", pages.smaller(before + text))


# What a page of one question takes for given.
_BEFORE = """
import tipoff
scene = tipoff.load("tiny")
curves = {name: tipoff.run(scene.condition(name)) for name in scene.agreement.fitted}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", ["README.md", "docs/tutorials/first_ejection.md", "docs/tutorials/your_launcher.md"]
)
def test_a_command_says_what_stands_below_it(page, tmp_path):
    """The numbers within one percent, but for those that tell how sensitive a run is: they depend
    on the last bits."""
    for text in pages.of_language(page, "toml")[:1]:
        (tmp_path / "my_launcher.toml").write_text(text)
    (block,) = pages.of_language(page, "console")
    command, _, shown = block[block.index("$ tipoff") :].partition("\n")
    arguments = shlex.split(command.removeprefix(pages.PROMPT))
    printed = _python(tmp_path, "-m", *arguments).splitlines()
    for line, own in zip(shown.splitlines(), printed):
        if line.split()[0] not in ("sensitivity", "warning"):
            assert re.sub(_NUMBER, "", line) == re.sub(_NUMBER, "", own)
            assert _numbers(own) == pytest.approx(_numbers(line), rel=0.01)


_NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"


def _numbers(line: str) -> list[float]:
    return [float(item) for item in re.findall(_NUMBER, line)]
