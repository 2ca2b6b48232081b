"""Both elastic kernels carry the same run: pencils on an extruded mesh, elements when told to forget that it is one."""

import numpy as np

import highfi
from highfi import Numerics
from highfi.run import Loop
from tests.highfi.support import loop_on, tiny


def test_pencils_and_elements_carry_the_same_run():
    scene, numerics = tiny(duration="15 ms"), Numerics(element_size=0.004)
    runs = []
    for forget in (False, True):
        loop: Loop = loop_on(scene, highfi.prepare(scene, numerics), numerics)
        assert loop.system.rail.pencils is not None
        if forget:
            loop.system = loop.system._replace(rail=loop.system.rail._replace(pencils=None))
        loop.begin()
        loop.march(None)
        runs.append(loop.trajectory({}, numerics))
    pencils, elements = runs
    assert np.abs(pencils.pad_force).max() > 1.0
    assert np.abs(pencils.rate - elements.rate).max() <= 1e-9 * np.abs(elements.rate).max()
    assert pencils.checks["transverse_energy_error"] <= 1e-3
