"""The modes of an ensemble with ``modes="auto"``: one number for all its cases, from a few of them.

``PILOT`` cases, evenly spaced, are run as single runs that choose their own number
(``lowfi.modes``). The ensemble takes the fewest modes that are enough for all but ``_LEFT_OUT`` of
them, so a few chaotic cases do not make all cases expensive. All cases then run the same equations,
and each can be run again by itself with this number.
"""

from dataclasses import replace

import numpy as np

from tipoff.lowfi import modes
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.numerics import AUTO
from tipoff.lowfi.run import solved
from tipoff.mechanics.models import COMPLIANT
from tipoff.mechanics.rail_compliance import model_of
from tipoff.scenes.faults import SceneError

PILOT = 16  # cases
_LEFT_OUT = 0.125  # of the pilot cases: the largest numbers


def settled(ensemble: Ensemble) -> tuple[Ensemble, str]:
    """``ensemble`` with a number of modes, and one line on why; the line is empty where the number
    was given or the model has no modes."""
    numerics = ensemble.numerics
    if numerics.modes != AUTO:
        return ensemble, ""
    if ensemble.scene.contact is None or model_of(ensemble.scene, ensemble.compliance) != COMPLIANT:
        return ensemble._replace(numerics=replace(numerics, modes=0)), ""
    chosen = sorted(_chosen(ensemble))
    count = chosen[int((1.0 - _LEFT_OUT) * (len(chosen) - 1))] if chosen else 0
    above = sum(number > count for number in chosen)
    why = (
        f"{count or 'none'}: enough for {len(chosen) - above} of {len(chosen)} cases that chose for "
        f"themselves, whose rates change by less than {np.degrees(modes.THRESHOLD):g} deg/s"
    )
    return ensemble._replace(numerics=replace(numerics, modes=count)), why


def _chosen(ensemble: Ensemble) -> list[int]:
    """Numbers of modes that the pilot cases choose; those that the scene refuses have none."""
    found, source = [], ensemble.source
    last, count = source.asked - 1, min(PILOT, source.asked)
    for number in np.linspace(0, last, count).round().astype(int).tolist():
        (row,) = source.rows(number, number + 1)
        try:
            run = solved(
                ensemble.scene.replace(row),
                ensemble.calibration,
                ensemble.numerics,
                compliance=ensemble.compliance,
            )
        except SceneError:
            continue
        found.append(int(run.numerics["modes"]))
    return found
