"""Description of this machine, for results that contain times, and the state of tipoff that made a result."""

import datetime
import functools
import os
import platform
import subprocess
from pathlib import Path

from tipoff import sources

_ROOT = Path(__file__).resolve().parents[2]
# Documents and kept results: an edit of them changes no number.
_NO_CODE = (":!docs", ":!*.md", ":!*/kept/*")


def describe() -> dict:
    """Processor, cores this process may use, memory (GiB), operating system and Python."""
    return {
        "processor": _line("/proc/cpuinfo", "model name") or platform.processor() or "unknown",
        "cores": cores(),
        "memory_gib": _memory(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }


def state() -> dict:
    """What makes a result now: ``version`` and ``commit`` of tipoff, ``date`` (UTC), ``processor`` and
    ``cores``. The commit ends with ``+`` if files of the clone other than documents and kept results
    differ from it, and is None outside a clone."""
    here = describe()
    return {
        "version": sources.version("tipoff"),
        "commit": commit(_ROOT),
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
        "processor": here["processor"],
        "cores": here["cores"],
    }


def stated(made: dict | None) -> str:
    """A ``state`` in words; that it is not recorded if there is none."""
    if not made:
        return "not recorded"
    where = f"commit {made['commit']}, " if made["commit"] else ""
    return f"tipoff {made['version']}, {where}{made['date']}, {made['processor']}, {made['cores']} cores"


@functools.cache
def commit(clone: Path) -> str | None:
    """The commit of a ``clone`` as in ``state``. Asked once: an edit during a run belongs to the next
    process."""
    if not (clone / ".git").exists():  # installed, or a copy without its history
        return None
    try:
        head, changed = (
            subprocess.run(["git", "-C", clone, *asked], capture_output=True, text=True, check=True)
            for asked in (
                ("rev-parse", "--short=12", "HEAD"),
                ("status", "--porcelain", "-uno", "--", ".", *_NO_CODE),
            )
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return head.stdout.strip() + ("+" if changed.stdout else "")


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _memory() -> float | None:
    found = _line("/proc/meminfo", "MemTotal")
    return round(int(found.split()[0]) / 2**20, 1) if found else None


def _line(path: str, name: str) -> str | None:
    try:
        lines = Path(path).read_text().splitlines()
    except OSError:
        return None
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(name)), None)
