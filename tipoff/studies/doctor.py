"""Is this machine able to run tipoff? Says in plain words what is missing and the one command that
mends it.

The mesher gmsh must be installed, but need not load: only solids drawn in CAD call for its system
libraries, and they say so (`meshes.generator`). This file imports nothing of the project: it must
work when the rest does not.
"""

import importlib
import importlib.util
import sys

OLDEST_PYTHON = (3, 11)

# h5py is nobody's direct import here: h5netcdf writes no file without it.
MODULES = (
    "numpy", "scipy", "numba", "skfem", "meshio", "pint", "pydantic", "typer", "rich",
    "xarray", "h5netcdf", "h5py", "cma", "matplotlib", "plotly",
)  # fmt: skip


def faults() -> list[str]:
    """Every reason why tipoff cannot run here, one sentence each; empty when it can."""
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
    """Print the findings; the exit code is 0 when everything is there and 1 otherwise."""
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
        f"the Python package {name} does not load ({reason}). `make` mends it: rm -rf .venv && "
        f"make .venv/.ready"
    )


if __name__ == "__main__":
    sys.exit(main())
