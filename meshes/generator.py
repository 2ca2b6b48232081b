"""The mesh generator gmsh, opened for one model at a time. Only solids drawn in CAD need it.

Its wheel does not contain the graphics libraries that it is linked against, so on a machine without
a desktop `import gmsh` fails with a loader error. This file imports nothing else, so that any Python
can read the list of packages.
"""

import contextlib

# The smallest set of packages on a minimal Debian 12, found one by one. The names are the same on
# Ubuntu.
SYSTEM_PACKAGES = ("libgl1", "libglu1-mesa", "libgomp1", "libxcursor1", "libxft2", "libxinerama1")
SYSTEM_INSTALL = "apt-get install --no-install-recommends " + " ".join(SYSTEM_PACKAGES)


class GmshUnavailable(RuntimeError):
    """gmsh does not load on this machine; the message, one line, names the missing part and the
    remedy."""


def load():
    """The module gmsh. Raises GmshUnavailable if it does not load."""
    try:
        import gmsh  # here and not above: only solids need gmsh
    except ModuleNotFoundError as error:
        raise GmshUnavailable(
            "a solid is meshed by gmsh, which is not installed: pip install gmsh"
        ) from error
    except OSError as error:
        library = str(error).split(":")[0]
        raise GmshUnavailable(
            f"a solid is meshed by gmsh, which lacks the system library {library}; on Debian and "
            f"Ubuntu, as "
            f"root: {SYSTEM_INSTALL}"
        ) from error
    return gmsh


@contextlib.contextmanager
def session(name: str):
    """gmsh with no signal handler, no user settings, one thread, no output; finalised at the end.

    Raises GmshUnavailable if it does not load.
    """
    gmsh = load()
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add(name)
        yield gmsh
    finally:
        gmsh.finalize()
