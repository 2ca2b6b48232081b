"""Files: what is not a regular file is not opened, and nothing is left half written."""

import errno
import os
import threading

import pytest

from tipoff import files, scenes
from tipoff.comparison.quantities import read_quantities
from tipoff.formats.sections.dxf import read_dxf
from tipoff.lowfi.ensemble.table import TableFile


def test_an_error_of_writing_names_the_file(tmp_path):
    with (
        pytest.raises(OSError, match="No space left") as caught,
        files.replacing(tmp_path / "a.txt"),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert caught.value.filename == str(tmp_path / "a.txt")
    assert list(tmp_path.iterdir()) == []


def test_the_files_of_all_threads_are_removed_at_once(tmp_path):
    """As at Ctrl-C, which waits for no thread."""
    begun, go_on = threading.Event(), threading.Event()

    def write():
        with files.replacing(tmp_path / "a.txt") as temporary:
            temporary.write_text("half")
            begun.set()
            go_on.wait(10.0)
            temporary.write_text("whole")

    thread = threading.Thread(target=write)
    thread.start()
    assert begun.wait(10.0) and len(list(tmp_path.iterdir())) == 1
    files.remove_temporaries()
    assert list(tmp_path.iterdir()) == []
    go_on.set()
    thread.join()
    # Control: a thread that had gone on would have ended its file.
    assert (tmp_path / "a.txt").read_text() == "whole"


@pytest.mark.parametrize("name", ["/dev/zero", "/", "a\0b"])
def test_only_regular_files_are_input(name):
    with pytest.raises(OSError):
        files.read_input(name)


@pytest.mark.parametrize(
    "encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-8", "utf-8-sig"]
)
def test_readers_of_text_know_the_encodings_of_windows(tmp_path, encoding):
    """A byte order mark states UTF-16, or every second byte is zero. Control: without knowing it no line
    is text."""

    def written(name, text):
        path = tmp_path / name
        path.write_bytes(text.encode(encoding))
        return path

    scene = written("own.toml", 'extends = "tiny"\nname = "own"\ndescription = "bär"\n')
    assert scenes.load(scene).description == "bär"
    assert TableFile(written("cases.csv", "payload.mass\nkg\n3\n4\n")).asked == 2
    curve = written(
        "a.csv", "time [s],rate_x [deg/s],rate_y [deg/s],rate_z [deg/s]\n0,0,1,2\n1,1,2,3\n"
    )
    found = read_quantities(curve, optional=("velocity_x",))
    assert not found.faults and found.values["time"].tolist() == [0.0, 1.0]
    pairs = "0 SECTION 2 HEADER 0 ENDSEC 0 SECTION 2 ENTITIES 0 LWPOLYLINE 90 3 70 1"
    pairs += " 10 0 20 0 10 1 20 0 10 0 20 1 0 ENDSEC 0 EOF"
    (loop,) = read_dxf(written("a.dxf", pairs.replace(" ", "\n") + "\n"), "m").loops
    assert len(loop) == 3


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"\xff\xfe\x00\xd8", b"\x89HDF\r\n", b""])
def test_bytes_that_are_no_text_stay(tmp_path, content):
    (tmp_path / "a").write_bytes(content)
    assert files.read_input(tmp_path / "a") == content


def test_input_is_read_up_to_a_size(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"x" * 100)
    assert files.read_input(path, 100) == b"x" * 100
    with pytest.raises(OSError, match="larger than"):
        files.read_input(path, 99)
