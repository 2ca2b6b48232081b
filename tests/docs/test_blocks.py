"""Every block of code of README and of the documentation: its language, its keys, its commands.
What takes more than a moment is run in ``test_runs``."""

import re
import tomllib

import pytest
from typer.exceptions import TyperException

import tipoff
from docs.pages.command_line import commands
from tests.docs import pages
from tipoff.scenes import SceneError, uncertainty

LANGUAGES = {"python", "toml", "bash", "console", "text", "yaml", "diff", ""}
DIRECTIVE = re.compile(r"\{[a-z-]+\}")
# Programs of others, with the page that tells how they come onto the machine.
PROGRAMS = {"tipoff", "make", "python", "python3", "pip", "dask", "openssl", "apt-get", "."}
TARGETS = re.findall(r"^([a-z-]+):.*##", (pages.ROOT / "Makefile").read_text(), re.MULTILINE)


@pytest.fixture(scope="module")
def launcher(tmp_path_factory):
    """The scene that README writes."""
    file = tmp_path_factory.mktemp("readme") / "my_launcher.toml"
    file.write_text(pages.of_language("README.md", "toml")[0])
    return tipoff.load(file)


@pytest.mark.parametrize("page", pages.PAGES)
def test_every_block_has_a_language(page):
    strange = {
        block.language
        for block in pages.blocks(page)
        if block.language not in LANGUAGES and not DIRECTIVE.match(block.language)
    }
    assert not strange


@pytest.mark.parametrize("page", pages.PAGES)
def test_every_command_is_one(page):
    for words in pages.commands(page):
        assert words[0] in PROGRAMS or "=" in words[0] or "/" in words[0], words
        if words[0] == "make":
            assert {word for word in words[1:] if "=" not in word} <= set(TARGETS), words


@pytest.mark.parametrize("page", pages.PAGES)
def test_every_option_and_key_of_a_command_is_known(page, launcher):
    for words in pages.tipoff(page):
        if words and not words[0].startswith("-"):
            _require_known(words, launcher)


@pytest.mark.parametrize(
    "wrong",
    [
        ["runs"],
        ["run", "--conditions", "phi35"],
        ["run", "--condition", "phi36"],
        ["run", "--set", "thermal.means=20 K"],
        ["run", "--scene", "referense"],
    ],
)
def test_a_wrong_command_is_refused(wrong, launcher):
    """The control of the test above."""
    with pytest.raises((KeyError, SceneError, TyperException)):
        _require_known(wrong, launcher)


def _require_known(words: list[str], launcher: tipoff.Scene) -> None:
    """Raises for an unknown command, option, scene, condition or key."""
    given = commands()[words[0]].make_context(words[0], list(words[1:])).params
    name = given.get("scene")
    if name is None:
        return
    scene = launcher if name.endswith(".toml") else tipoff.load(name)
    chosen = given.get("condition") or ()
    for condition in [chosen] if isinstance(chosen, str) else chosen:
        scene.condition(condition)
    scene.replace(dict(text.split("=", 1) for text in given.get("set_") or ()))


def _toml(page: str) -> list[str]:
    return pages.of_language(page, "toml")


@pytest.mark.parametrize("page", [page for page in pages.PAGES if _toml(page)])
def test_every_toml_block_is_a_scene_or_a_file_of_distributions(page, tmp_path):
    (tmp_path / "thrust.csv").write_text("time_s,force_N\n0,0\n0.01,6000\n0.02,0\n")
    motor = "M1670-BS 75 757 0 3.101 5.231 CTI\n0.1 2000\n0.5 1950\n3.9 0\n"
    (tmp_path / "Cesaroni.eng").write_text(motor + motor.replace("M1670", "M1400"))
    (tmp_path / "rocketpy.csv").write_text("0,0\n0.01,6000\n0.02,0\n")
    rows = "".join(f"{0.1 * k:.1f};{4 + 500 * (32 <= k < 40)}\n" for k in range(60))
    (tmp_path / "firing.csv").write_text("Time [s];Force [N]\n" + rows)
    for file in ("channel.msh", "launcher.k", "rails.step"):
        (tmp_path / file).touch()
    scene = tipoff.load("reference")  # distributions are of the scene that stands before them
    for number, text in enumerate(_toml(page)):
        file, table = tmp_path / f"{number}.toml", tomllib.loads(text)
        if "vary" in table:
            head = "" if "cases" in table else "cases = 10\n"
            file.write_text(head + text)
            uncertainty.load(file, scene)
            continue
        whole = bool({"extends", "deployer", "lugs"} & set(table))
        head = "" if whole else 'extends = "reference"\n'
        head += "" if "name" in table else f'name = "block{number}"\n'
        file.write_text(head + text)
        scene = tipoff.load(file)
