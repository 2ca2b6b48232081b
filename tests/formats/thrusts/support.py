"""Scenes with a thrust from a file that a test writes out."""

import numpy as np

from tests.scenes.support import refused, small
from tipoff.scenes import parse


def thrust(folder, name, text, **keys):
    """The thrust table of a scene with this file; text is written in UTF-8, bytes as they are."""
    file = folder / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return parse(small(thrust={"kind": "measured", "file": str(file)} | keys)).thrust


def refusal(folder, name, text, **keys):
    """The expected value in the only fault of such a scene, on one line."""
    file = folder / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    (fault,) = refused(small(thrust={"kind": "measured", "file": str(file)} | keys))
    assert fault.key.startswith("thrust.") and "\n" not in str(fault)
    return fault.expected


def points(table):
    """Times (s) and forces (N) of a thrust."""
    return [np.asarray(values).tolist() for values in table.curve()]
