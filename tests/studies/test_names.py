"""Results are filed by the names of scenes and conditions, and no name leads anywhere else."""

import pytest
from typer.testing import CliRunner

from tests.scenes.support import small
from tipoff.scenes import SceneError, load, parse
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.cli import app
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

WRONG = [
    "../../../escaped",
    "/tmp/escaped",
    "..",
    ".",
    "",
    ".hidden",
    "-x",
    "_x",
    "a/b",
    "a\\b",
    "a b",
    "a:b",
    "a\n",
    "a\0b",
    "é",
    "١",
    "x" * 65,
]
RIGHT = ["a", "phi15", "0", "A-b_c.d", "x" * 64]
EXPECTED = (
    'expected at most 64 letters a-z, A-Z, digits, "-", "_" and ".", the first a letter or digit'
)


def call(*arguments):
    return CliRunner().invoke(app, [str(item) for item in arguments])


@pytest.mark.parametrize("name", WRONG)
def test_names_that_are_none_of_files_are_faults_of_the_scene(name):
    with pytest.raises(SceneError) as fault:
        parse(small(conditions={name: {"duration": "20 ms"}}))
    assert [(item.key, item.given) for item in fault.value.faults] == [("conditions", repr(name))]
    assert EXPECTED in str(fault.value)
    with pytest.raises(SceneError) as fault:
        parse(small(name=name))
    assert [item.key for item in fault.value.faults] == ["name"] and EXPECTED in str(fault.value)
    for override in ({"name": name}, {"conditions": {name: {"duration": 0.02}}}):
        with pytest.raises(SceneError, match="at most 64 letters"):
            parse(small()).replace(override)


@pytest.mark.parametrize("name", ["nominal", "Nominal"])
def test_no_condition_has_the_name_of_the_scene_itself(name):
    """It took the place of the scene in `tipoff run SCENE`."""
    with pytest.raises(SceneError, match="this one is of the scene itself") as fault:
        parse(small(conditions={name: {"duration": "20 ms"}}))
    assert [(item.key, item.given) for item in fault.value.faults] == [("conditions", repr(name))]
    assert parse(small(name=name)).condition("nominal").name == name


@pytest.mark.parametrize("name", RIGHT)
def test_names_of_files_are_taken(name):
    scene = parse(small(name=name, conditions={name: {"duration": "20 ms"}}))
    assert scene.name == name and scene.condition(name).duration == 0.02


def test_every_wrong_name_is_listed_with_all_other_faults():
    with pytest.raises(SceneError) as fault:
        parse(
            small(
                name="a/b",
                payload__mass="-1 kg",
                agreement={"fitted": ["none"]},
                conditions={"../a": {"payload.mass": "-2 kg"}, "/b": {}, "ok": {}},
            )
        )
    assert sorted((item.key, item.given) for item in fault.value.faults) == [
        ("agreement.fitted", "'none'"),
        ("conditions", "'../a'"),
        ("conditions", "'/b'"),
        ("conditions.../a.payload.mass", "'-2 kg'"),
        ("name", "'a/b'"),
        ("payload.mass", "'-1 kg'"),
    ]


def test_conditions_that_differ_in_case_only_are_refused():
    """One folder would receive both where a disk does not tell them apart. Control: two that differ
    in a letter."""
    with pytest.raises(
        SceneError,
        match="'PHI1', expected a name that differs from 'phi1' in more than upper and lower case",
    ):
        parse(small(conditions={"phi1": {}, "PHI1": {"duration": "20 ms"}}))
    assert list(parse(small(conditions={"phi1": {}, "PHI2": {}})).conditions) == ["phi1", "PHI2"]


@pytest.mark.parametrize(
    "line",
    [
        '[conditions."../../../escaped"]\nduration = "20 ms"\n',
        '[conditions."{folder}/escaped"]\nduration = "20 ms"\n',
        'name = "../escaped"\n',
    ],
)
@pytest.mark.parametrize(
    "command", [["run", "--condition", "{name}"], ["run", "--all"], ["view", "--mesh"]]
)
def test_a_name_that_escapes_is_exit_code_2_and_nothing_is_written(tmp_path, line, command):
    inside = tmp_path / "deep" / "er"
    inside.mkdir(parents=True)
    scene = inside / "mine.toml"
    line = line.replace("{folder}", str(tmp_path))
    scene.write_text(
        'extends = "tiny"\n' + ("" if line.startswith("name") else 'name = "mine"\n') + line
    )
    name = line.split('"')[1]
    told = call(
        *[part.replace("{name}", name) for part in command],
        "--scene",
        scene,
        "--out",
        inside / "out",
    )
    assert told.exit_code == 2 and "at most 64 letters" in told.stderr and name in told.stderr
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [scene] and not list(
        tmp_path.rglob("escaped*")
    )


def test_options_name_only_what_the_scene_has(tmp_path):
    """Overrides cannot add a name that escapes, and references and conditions are those of the
    scene."""
    for arguments in (
        ["--set", "name=../escaped"],
        ["--set", "conditions.../x.duration=20 ms"],
        ["--condition", "../escaped"],
    ):
        told = call("run", "--scene", "tiny", "--out", tmp_path / "out", *arguments)
        assert told.exit_code == 2 and "Traceback" not in told.output
    study = Study(load("tiny"), tmp_path / "out" / "tiny", Settings())
    with pytest.raises(SceneError, match="given '../escaped', expected one of"):
        calibrate.from_files(study, [("../escaped", "none.csv")])
    assert list(tmp_path.iterdir()) == []


def test_a_file_whose_name_is_none_says_how_to_name_its_scene(tmp_path):
    path = tmp_path / "my launcher.toml"
    path.write_text('extends = "tiny"\n')
    with pytest.raises(
        SceneError,
        match="name: given 'my launcher'.*without this key is called by the name of the file",
    ):
        load(path)
    path.write_text('extends = "tiny"\nname = "my_launcher"\n')
    assert load(path).name == "my_launcher"
