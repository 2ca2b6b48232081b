"""Settings every test shares: pictures are drawn without a display, and property tests draw the
same examples each time.

The directory of compiled kernels is chosen by `kernels.jit`, for tests and runs alike. To look for
new examples, run pytest with `--hypothesis-profile=explore`. Tests marked `gmsh` are skipped where
gmsh does not load, which a rail drawn in CAD alone needs.
"""

import functools
import gc
import os

import pytest
import scipy.linalg  # noqa: F401  its BLAS is loaded before its threads are limited
from hypothesis import settings
from threadpoolctl import threadpool_limits

from tipoff.meshes import generator

os.environ.setdefault("MPLBACKEND", "Agg")
if "PYTEST_XDIST_WORKER" in os.environ:  # one on each core: threads of a run would only wait
    os.environ.setdefault("OMP_NUM_THREADS", "1")
threadpool_limits(limits=1, user_api="blas")  # a worker on each core: more threads only wait
gc.set_threshold(100_000, 50, 50)  # tests hold much and leave little: a tenth of their time
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None)
settings.load_profile("repeatable")


@functools.cache
def _without_gmsh() -> str:
    """Why gmsh does not load here; empty where it does."""
    try:
        generator.load()
    except generator.GmshUnavailable as reason:
        return str(reason)
    return ""


@pytest.hookimpl(tryfirst=True)  # before fixtures are made, which may call gmsh
def pytest_runtest_setup(item):
    if item.get_closest_marker("gmsh") and _without_gmsh():
        pytest.skip(_without_gmsh())
