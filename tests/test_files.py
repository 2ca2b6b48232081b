"""Files: what is not a regular file is not opened, and nothing is left half written."""

import errno
import os
import threading

import pytest

from tipoff import files


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


def test_input_is_read_up_to_a_size(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"x" * 100)
    assert files.read_input(path, 100) == b"x" * 100
    with pytest.raises(OSError, match="larger than"):
        files.read_input(path, 99)
