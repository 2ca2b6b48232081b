"""Errors that come back from another process say what they said there."""

import pickle

import pytest

from tipoff.files import DamageError
from tipoff.highfi.dynamics.checkpoint import CheckpointError
from tipoff.scenes.faults import Fault, SceneError


@pytest.mark.parametrize(
    "error",
    [
        SceneError([Fault("a", "b", "1 m", "2 m"), Fault("a", "c", "nothing", "this key")]),
        CheckpointError("run.npz", "is damaged"),
        DamageError("run.npz", "is damaged"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_an_error_survives_the_way_from_a_process(error):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error) and vars(again) == vars(error)
