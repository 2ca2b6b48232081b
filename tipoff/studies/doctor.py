"""Checks whether tipoff can run on this machine; prints what is missing and how to repair it.

The mesher gmsh must be installed, but it is not loaded: only CAD solids need its system libraries
(`meshes.generator` reports them). This file imports nothing of the project, so it works when the rest
fails.
"""

import importlib
import importlib.util
import sys

OLDEST_PYTHON = (3, 11)

MODULES = (
    "numpy", "scipy", "numba", "skfem", "meshio", "pint", "pydantic", "typer", "rich",
    "xarray", "h5netcdf", "h5py", "cma", "matplotlib",
)  # fmt: skip


def faults() -> list[str]:
    """Every reason why tipoff cannot run here, one sentence each; empty if it can."""
    found = []
    if sys.version_info < OLDEST_PYTHON:
        found.append(
            f"Python {sys.version.split()[0]} is too old: tipoff needs "
            f"{'.'.join(map(str, OLDEST_PYTHON))} or newer."
        )
    found += [
        _python_package_fault(name, reason) for name in MODULES if (reason := _import_error(name))
    ]
    if importlib.util.find_spec("gmsh") is None:
        found.append(_python_package_fault("gmsh", "not installed"))
    return found


def main() -> int:
    """Print the faults; returns the exit code, 0 without faults and 1 otherwise."""
    found = faults()
    for fault in found:
        print(f"tipoff: {fault}", file=sys.stderr)
    if not found:
        print("tipoff: this machine has everything it needs.")
    return 1 if found else 0


def _import_error(name: str) -> Exception | None:
    try:
        importlib.import_module(name)
    except (ImportError, OSError) as reason:
        return reason
    return None


def _python_package_fault(name: str, reason: Exception | str) -> str:
    return (
        f"the Python package {name} does not load ({reason}). To repair it: rm -rf .venv && make "
        ".venv/.ready"
    )


if __name__ == "__main__":
    sys.exit(main())
