"""Is this machine able to run tipoff? Says in plain words what is missing and the one command that mends it.

gmsh's wheel brings the mesher but not the graphics libraries it is linked against, so on a machine without a desktop
`import gmsh` fails with a loader error. This file imports nothing of the project: it must work when the rest does not.
"""

import importlib
import sys

OLDEST_PYTHON = (3, 11)

# All six are needed and no fewer: tried one by one on a minimal Debian 12. The names are the same on Ubuntu.
SYSTEM_PACKAGES = ("libgl1", "libglu1-mesa", "libgomp1", "libxcursor1", "libxft2", "libxinerama1")
SYSTEM_INSTALL = "apt-get install --no-install-recommends " + " ".join(SYSTEM_PACKAGES)

# h5py is nobody's direct import here: h5netcdf writes no file without it.
MODULES = (
    "numpy", "scipy", "numba", "skfem", "meshio", "pint", "pydantic", "typer", "rich",
    "xarray", "h5netcdf", "h5py", "cma", "matplotlib", "plotly",
)  # fmt: skip


def faults() -> list[str]:
    """Every reason why tipoff cannot run here, one sentence each; empty when it can."""
    found = []
    if sys.version_info < OLDEST_PYTHON:
        found.append(f"Python {sys.version.split()[0]} is too old: tipoff needs {'.'.join(map(str, OLDEST_PYTHON))} or newer.")
    found += [_python_package_fault(name, reason) for name in MODULES if (reason := _import_error(name))]
    if reason := _import_error("gmsh"):
        found.append(_gmsh_fault(reason))
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


def _python_package_fault(name: str, reason: Exception) -> str:
    return f"the Python package {name} does not load ({reason}). `make` mends it: rm -rf .venv && make .venv/.ready"


def _gmsh_fault(reason: Exception) -> str:
    if isinstance(reason, ModuleNotFoundError):
        return _python_package_fault("gmsh", reason)
    library = str(reason).split(":")[0]
    return (
        f"the mesher gmsh does not load, because the system library {library} is missing. On Debian and Ubuntu this mends it\n"
        f"(as root, or with sudo before it):\n\n    {SYSTEM_INSTALL}\n"
    )


if __name__ == "__main__":
    sys.exit(main())
