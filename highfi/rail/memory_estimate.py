"""Estimate of the memory that a run needs, and the memory that is available to this process.

    bytes = FIXED + PER_ELEMENT elements

Measured as the largest resident set of mesh, set-up and run of the reference rails: 154,880
elements take 0.35 GB beyond the 0.2 GB of the interpreter with its libraries, 1.24 million 2.7 GB,
4.05 million 8.7 GB. The mesh generator takes most of it and frees it before the first step. In a
mesh without equal elements, every element also has its own matrix, stored three times during the
assembly. Joints under the mounts take 180 bytes per element at 4 mm and 95 at 2 mm; the constants
include them.
"""

from pathlib import Path

FIXED = 6e7  # compiled kernels and other memory that does not grow with the mesh
PER_ELEMENT = 2300
_PER_MESHED = 1200  # per element of eight nodes, after the mesh is made
_COPIES = 3  # of the matrices of all elements, during the assembly
_UNLIMITED = 2**60  # the limit of an unlimited control group is above this number


def of_section(elements: int) -> float:
    """Bytes for rails of so many hexahedra, from before they are meshed until the end of a run."""
    return FIXED + PER_ELEMENT * elements


def of_mesh(elements: int, nodes: int, shapes: int) -> float:
    """Bytes for a mesh that is already read until the end of a run: ``elements`` with ``nodes``
    nodes each in ``shapes`` classes."""
    return FIXED + _PER_MESHED * elements * nodes / 8 + _COPIES * 8 * (3 * nodes) ** 2 * shapes


def available(system: Path = Path("/")) -> int | None:
    """Bytes available to this process: the smaller of what the machine and its control group have
    left; None if both are unknown."""
    found = [_of_machine(system), *_of_groups(system)]
    return min((value for value in found if value is not None), default=None)


def in_words(amount: float) -> str:
    """Text of a number of bytes, in GB."""
    return f"{amount / 1e9:.2g} GB" if amount < 1e10 else f"{amount / 1e9:,.0f} GB"


def _of_machine(system: Path) -> int | None:
    for line in _text(system / "proc/meminfo").splitlines():
        name, _, value = line.partition(":")
        if name == "MemAvailable":
            return 1024 * int(value.split()[0])
    return None


def _of_groups(system: Path) -> list[int | None]:
    """Bytes left of the limits of this process's control group and of those around it, in versions
    1 and 2."""
    root, left = system / "sys/fs/cgroup", []
    for line in _text(system / "proc/self/cgroup").splitlines():
        _, controllers, group = line.split(":", 2)
        if controllers == "" or "memory" in controllers.split(","):
            base = root if controllers == "" else root / "memory"
            parts = Path(group.lstrip("/")).parts
            left += [_left(base.joinpath(*parts[:depth])) for depth in range(len(parts) + 1)]
    return left


def _left(group: Path) -> int | None:
    """Limit minus use; cached files count as free."""
    for limit, used, cached in (
        ("memory.max", "memory.current", "inactive_file"),
        ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
    ):
        most, now = _text(group / limit).strip(), _text(group / used).strip()
        if most.isdigit() and now.isdigit() and int(most) < _UNLIMITED:
            entries = dict(
                line.split()[:2]
                for line in _text(group / "memory.stat").splitlines()
                if " " in line
            )
            return max(0, int(most) - int(now) + int(entries.get(cached, 0)))
    return None


def _text(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:  # another system, or a group that is gone
        return ""
