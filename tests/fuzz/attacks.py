"""Attacks on whole commands: they are killed, their disk is full, two write one folder at once. Each
function returns what did not hold, nothing where all did."""

import contextlib
import hashlib
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

_KILLS = 10
_SIZES = ("64k", "128k", "256k", "512k", "1m", "2m")
ENSEMBLE = ("ensemble", "--scene", "tiny", "--model", "springs", "--cases", "20000")
LOWFI = ("run", "--all", "--scene", "tiny")
MESH = ("view", "--mesh", "--scene", "tiny")


def command(*arguments: str, out: Path) -> subprocess.Popen:
    """A command of tipoff that writes into ``out``."""
    return subprocess.Popen(
        [sys.executable, "-m", "tipoff", *arguments, "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def ended(process: subprocess.Popen, codes: tuple[int, ...]) -> str:
    """What is wrong with the end of a command: another exit code than one of ``codes``, or a
    traceback."""
    _, said = process.communicate(timeout=600)
    if process.returncode not in codes or "Traceback" in said:
        return f"exit {process.returncode}: {said[-500:]}"
    return ""


def halves(folder: Path) -> list[str]:
    """Temporary files that a command left."""
    return [str(path) for path in folder.rglob(".*") if path.is_file()]


def digest(folder: Path) -> str:
    """Of the stored numbers of ensembles."""
    marks = sorted(folder.rglob("done/*.json"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in marks)).hexdigest()


def kills(folder: Path) -> str:
    """An ensemble that is killed again and again ends in the same numbers."""
    if said := ended(command(*ENSEMBLE, out=folder / "whole"), (0,)):
        return said
    rng = random.Random(1)
    for _ in range(_KILLS):
        process = command(*ENSEMBLE, out=folder / "killed")
        time.sleep(rng.uniform(0.5, 4.0))
        process.kill()
        process.communicate()
    if said := ended(command(*ENSEMBLE, out=folder / "killed"), (0,)):
        return said
    return "" if digest(folder / "killed") == digest(folder / "whole") else "other numbers"


def interrupts(folder: Path) -> str:
    """Ctrl-C at any time, that of loading included, ends with 130 and leaves no temporary file."""
    for number in range(_KILLS):
        process = command(*LOWFI, out=folder)
        time.sleep(0.3 + 0.3 * number)
        process.send_signal(signal.SIGINT)
        if said := ended(process, (0, 130)):
            return f"after {0.3 + 0.3 * number:g} s, {said}"
        if left := halves(folder):
            return f"left {left}"
    return ""


def full_disks(folder: Path) -> str:
    """On a file system that is too small a command ends with 1 and one line, and leaves nothing half
    written. Needs the right to mount one."""
    for arguments in (LOWFI, ENSEMBLE, MESH):
        for size in _SIZES:
            with small_disk(folder / size, size) as place:
                if place is None:
                    return ""
                if said := ended(command(*arguments, out=place), (0, 1)):
                    return f"{arguments[0]} on {size}: {said}"
                if left := halves(place):
                    return f"{arguments[0]} on {size} left {left}"
    return ""


@contextlib.contextmanager
def small_disk(place: Path, size: str) -> Iterator[Path | None]:
    """A file system of ``size`` at ``place``; None where this process may not mount one."""
    place.mkdir(exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(place)]
    try:
        is_there = subprocess.run(mount, capture_output=True).returncode == 0
    except OSError:
        is_there = False
    try:
        yield place if is_there else None
    finally:
        if is_there:
            subprocess.run(["umount", str(place)], check=True)


def two_at_once(folder: Path) -> str:
    """Two processes that fill one store both end well, with the numbers of one."""
    together = [command(*ENSEMBLE, out=folder / "two") for _ in range(2)]
    said = [words for process in together if (words := ended(process, (0,)))]
    if said:
        return "; ".join(said)
    if said := ended(command(*ENSEMBLE, out=folder / "one"), (0,)):
        return said
    return "" if digest(folder / "two") == digest(folder / "one") else "other numbers"


def unwritable(folder: Path) -> str:
    """A folder of results that cannot be made: exit code 1 and one line."""
    (folder / "file").write_text("")
    (folder / "loop").symlink_to(folder / "loop")
    places = [folder / "file", folder / "loop", Path(os.devnull), folder / ("a" * 300)]
    for place in places:
        if said := ended(command(*MESH, out=place), (1,)):
            return f"{place}: {said}"
    return ""


ATTACKS: dict[str, Callable[[Path], str]] = {
    "kills": kills,
    "interrupts": interrupts,
    "full disks": full_disks,
    "two at once": two_at_once,
    "folders that cannot be written": unwritable,
}
