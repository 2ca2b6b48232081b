"""Largest load of each pad of the reference: against samples as close as its steps nearly are."""

import numpy as np

from tests.highfi.support import COARSE, SOON, tiny
from tipoff import highfi
from tipoff.scenes import scene_model


def test_the_largest_force_is_that_of_close_samples():
    """For any sampling. Control: the largest of the usual samples is below it. The moment is that of the
    force within the faces of the pad."""
    usual, close = (
        highfi.run(tiny(**SOON | {"output__interval": interval}), COARSE)
        for interval in ("0.25 ms", "2 us")
    )
    # a step divides the interval, so the runs have not the same steps
    np.testing.assert_allclose(
        usual.guide_force, close.guide_force, atol=1e-3 * np.abs(close.guide_force).max()
    )
    faces = scene_model.build(tiny(**SOON)).faces
    sizes, seen = (_sizes(run, faces.guide) for run in (close, usual))
    found = np.linalg.norm(close.guide_force, axis=1)
    loaded = found > 1.0
    assert loaded.sum() >= 2
    np.testing.assert_allclose(found[loaded], sizes[loaded], rtol=1e-2)
    assert (found >= (1.0 - 1e-12) * sizes).all()
    assert (seen[loaded] < 0.9 * found[loaded]).any()
    for guide in np.flatnonzero(loaded):
        own = faces.guide == guide
        moment = np.cross(faces.centre[own].mean(axis=0), close.guide_force[guide])
        reach = faces.half_length[own].max() + np.ptp(faces.centre[own], axis=0).max()
        assert np.linalg.norm(close.guide_moment[guide] - moment) <= reach * found[guide]
        assert np.linalg.norm(close.guide_moment[guide]) > 0.0


def _sizes(run, guide) -> np.ndarray:
    found = np.zeros((run.time.size, guide.max() + 1, 3))
    np.add.at(found, (slice(None), guide), run.pad_force)
    return np.linalg.norm(found, axis=2).max(axis=0)
