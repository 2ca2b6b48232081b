"""Output on terminals and in files whose encoding is not UTF-8: the program spells what it cannot print."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SPELLED = {"±": "+-", "²": "2", "µ": "u", "–": "-", "─": "-", "│": "|"}
SPELLED |= dict.fromkeys("╭╮╯╰", "+") | dict.fromkeys("“”", '"')
KEPT = ROOT / "tests/studies/kept/texts"
# The program with another command line: it prints the texts of every study on both streams, the second one
# beside progress bars.
PRINT = """
import sys
from pathlib import Path
from tipoff import __main__ as program
from tipoff.studies import cli
from tipoff.workspace import progress

def app():
    progress._SHOWN_AFTER = 0.0
    files = sorted(Path(sys.argv[1]).glob("[ht]*/*.txt"))
    texts = [path.read_text(encoding="utf-8") for path in files]
    with progress.Board("µ", 2) as board:
        for text in texts:
            board.callback("λ")(0.5)
            progress.say(text)
    for text in texts:
        print(text)

cli.app = app
program.main()
"""


def encodable(character: str, encoding: str) -> bool:
    try:
        return bool(character.encode(encoding))
    except UnicodeEncodeError:
        return False


def printed(encoding: str, *arguments: str | bytes, **variables: str) -> tuple[str, str, int]:
    """Both streams of Python with the ``arguments``, decoded, and its exit code."""
    done = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        cwd=ROOT,
        env=os.environ | {"PYTHONIOENCODING": encoding} | variables,
    )
    return done.stdout.decode(encoding), done.stderr.decode(encoding), done.returncode


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "latin-1", "cp437", "koi8-r", "shift_jis"])
def test_every_text_of_the_program_prints_in_any_encoding(encoding):
    whole = "".join(
        path.read_text(encoding="utf-8") + "\n" for path in sorted(KEPT.glob("[ht]*/*.txt"))
    )
    with pytest.raises(UnicodeEncodeError):  # what Python does by itself
        whole.encode(encoding)
    expected = "".join(
        character if encodable(character, encoding) else SPELLED[character] for character in whole
    )
    for variables in ({}, {"FORCE_COLOR": "1"}):  # to a file, and as if to a terminal
        out, error, code = printed(encoding, "-c", PRINT, str(KEPT), **variables)
        assert code == 0 and "Traceback" not in error
        assert out == expected


def test_a_command_prints_its_table_its_files_and_its_help_in_ascii(tmp_path):
    mesh = ("-m", "tipoff", "view", "--mesh", "--scene", "tiny", "--out", str(tmp_path))
    out, error, code = printed("ascii", *mesh)
    assert code == 0, error
    assert "Deflection here" in out and " um, lowest" in out
    assert str(tmp_path / "tiny" / "mesh.json") in out
    out, error, code = printed("ascii", "-m", "tipoff", "run", "--help")
    assert code == 0 and "+- Options ---" in out, error


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_a_file_name_that_is_not_text_is_printed_byte_for_byte(encoding):
    done = subprocess.run(
        [sys.executable, "-m", "tipoff", "run", "--scene", b"no_\xff.toml"],
        capture_output=True,
        cwd=ROOT,
        env=os.environ | {"PYTHONIOENCODING": encoding},
    )
    assert done.returncode == 2
    assert b"no_\xff.toml: file: given No such file" in done.stderr
    assert b"Traceback" not in done.stderr
