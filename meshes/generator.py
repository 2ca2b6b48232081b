"""The mesh generator gmsh, opened for one model at a time."""

import contextlib


@contextlib.contextmanager
def session(name: str):
    """gmsh with no signal handler, no user settings, one thread, no output; finalised on the way out."""
    try:
        import gmsh  # here and not above: a run that reads a .msh file needs none of gmsh's graphics libraries
    except OSError as error:
        raise RuntimeError(
            f"gmsh cannot be loaded ({error}). Its system libraries come with: apt-get install libgl1 libglu1-mesa "
            "libxcursor1 libxft2 libxinerama1 libxrender1 libgomp1") from error
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add(name)
        yield gmsh
    finally:
        gmsh.finalize()
