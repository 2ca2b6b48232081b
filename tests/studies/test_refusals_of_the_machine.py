"""What the machine refuses, and Ctrl-C: exit code 1 or 130 and one line, no traceback."""

import errno
import os
import signal
import subprocess
import sys
import time

import pytest
import typer
from typer.testing import CliRunner

from tipoff.studies.cli import app
from tipoff.studies.commands.running import guarded

# A shell starts jobs in the background with Ctrl-C ignored.
INTERRUPTIBLE = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
CODE = "import sys; from tipoff.__main__ import main; sys.argv = ['tipoff', 'scenes']; main()"


def raising(error):
    def work():
        raise error

    return work


@pytest.mark.parametrize(
    "error, words",
    [
        (OSError(errno.ENOSPC, "No space left on device", "out/a.nc"), "out/a.nc: No space left"),
        (OSError("a reason without a number"), "a reason without a number"),
        (MemoryError("Unable to allocate 8.00 GiB"), "memory does not suffice (Unable to"),
        (MemoryError(), "memory does not suffice"),
    ],
)
def test_it_is_exit_code_1_and_one_line(error, words, capsys):
    with pytest.raises(typer.Exit) as caught:
        guarded(raising(error))
    said = capsys.readouterr().err
    assert caught.value.exit_code == 1
    assert said.startswith(f"tipoff: {words}") and said.count("\n") == 1


def test_other_errors_are_not_hidden():
    """Control: a mistake of ours keeps its traceback."""
    with pytest.raises(KeyError):
        guarded(raising(KeyError("x")))


def test_results_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file", tmp_path / ("a" * 300)):
        command = (
            "view",
            "--mesh",
            "--scene",
            "tiny",
            "--set",
            "studies.element_size=8 mm",
            "--out",
            str(place),
        )
        done = CliRunner().invoke(app, command)
        assert done.exit_code == 1 and isinstance(done.exception, SystemExit)
        assert done.stderr.splitlines()[-1].startswith("tipoff: ")


def test_a_folder_of_kernels_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    done = subprocess.run(
        [sys.executable, "-m", "tipoff", "run", "--scene", "tiny", "--model", "springs"],
        cwd=tmp_path,
        env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "file")},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert "set NUMBA_CACHE_DIR" in done.stderr


@pytest.mark.parametrize("after", [0.15, pytest.param(0.4, marks=pytest.mark.slow), 0.8])
def test_ctrl_c_while_the_command_loads(after):
    ready = f"{INTERRUPTIBLE}; import sys; print('ready', flush=True); {CODE}"
    process = subprocess.Popen(
        [sys.executable, "-c", ready],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode in (0, 130) and "Traceback" not in said


IN_A_CALLBACK = """
import signal, sys, time, weakref
from tipoff import __main__

class Interrupted:
    \"\"\"Imports nothing; while the commands load, Ctrl-C falls into a callback.\"\"\"

    def find_spec(self, name, path=None, target=None):
        if name == "tipoff.studies.cli":
            gone = Interrupted()
            reference = weakref.ref(gone, lambda _: signal.raise_signal(signal.SIGINT))
            del gone
            print("dropped", flush=True)
            time.sleep({wait})

sys.meta_path.insert(0, Interrupted())
sys.argv = ["tipoff", "scenes"]
{before}
__main__.main()
"""


@pytest.mark.parametrize(
    "before, code", [("", 130), ("__main__._keep_interrupts = lambda _: None", 0)]
)
def test_ctrl_c_in_a_callback_of_python_is_not_lost(before, code):
    """Control: Python alone drops it and the command goes on."""
    wait = 0.0 if code == 0 else 30.0
    script = f"{INTERRUPTIBLE}\n{IN_A_CALLBACK.format(wait=wait, before=before)}"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == code and done.stdout.startswith("dropped")
    assert "Traceback" not in done.stderr
    assert ("tipoff: stopped" in done.stderr) == (code == 130)
