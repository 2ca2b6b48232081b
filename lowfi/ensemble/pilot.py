"""Number of modes of an ensemble with ``modes="auto"``: one for all its cases, chosen from a few of
them.

``PILOT`` cases, evenly spaced, are single runs that choose their own number (``lowfi.modes``). The
ensemble takes the fewest modes that are sufficient for half of them, so a minority of cases with
modes does not make all cases expensive. On scene ``reference`` half of the random ejections choose
modes, and four modes make a case ten times as expensive (docs/rail_modes.md). A pilot case is
integrated at least as accurately as a single run at the default tolerance, because the forces of a
coarse integration excite modes that the contact does not.

A case is chaotic if 1 um of clearance changes its rates by more than half of their size. Then the rates
with and without modes differ by chance, and only the distribution of many cases counts. Such a case
takes the fewest modes for which the others would change its rates directly, without growth in later
contacts, by less than a tenth of their size (``lowfi.contact.compliant.neglected``). On scene
``cubesat_3u`` it needs none, on ``rocket_rail`` eight, and the distributions agree (docs/rail_modes.md).

All cases have the same equations, and each can be run again alone with this number. A store keeps
the number with its reason, so an ensemble with a store has one pilot.
"""

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tipoff.faults import SceneError
from tipoff.lowfi import modes
from tipoff.lowfi.ensemble import store as stores
from tipoff.lowfi.ensemble import twins
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.lowfi.simulation import solved
from tipoff.lowfi.single_run import SingleRun, integrated
from tipoff.scenes.rail_compliance import may_vibrate
from tipoff.scenes.scene import Scene

PILOT = 16  # cases
_ENOUGH_FOR = 0.5  # of the pilot cases
# Change by the clearance over the total rate: 0 to 0.01 on ``reference``, 0.8 to 3.4 on chaotic scenes.
_CHAOTIC = 0.5
# Direct effect of all modes over the total rate: up to 0.06 on ``cubesat_3u``, 1.3 to 10 on ``rocket_rail``.
_DIRECT = 0.1


class Pilot(NamedTuple):
    """The number of modes that a case chooses, and whether the case is chaotic."""

    modes: int
    chaotic: bool


def settled(
    ensemble: Ensemble,
    store: str | Path | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Ensemble:
    """``ensemble`` with a number of modes, and the reason as its ``modes_why``, which is empty if
    the number was given or the model has no modes. No case is run if the ``store`` at this path
    belongs to the same ensemble and has the number. ``progress`` is called with the share of pilot
    cases done. Raises ValueError for a degree that is not chosen: all cases have one."""
    if ensemble.numerics.degree == AUTO:
        raise ValueError("degree: given 'auto', expected the number that all cases have")
    if ensemble.numerics.modes != AUTO:
        return ensemble
    if not may_vibrate(ensemble.scene, ensemble.compliance):
        return _with(ensemble, 0, "")
    if store is not None and (found := _kept(ensemble, Path(store))) is not None:
        return found
    pilots = _chosen(ensemble, progress)
    chosen = sorted(each.modes for each in pilots)
    count = chosen[int(_ENOUGH_FOR * (len(chosen) - 1))] if chosen else 0
    above = sum(number > count for number in chosen)
    chaotic = sum(each.chaotic for each in pilots)
    enough = f"{count or 'none'}: enough for {len(chosen) - above} of {len(chosen)} pilot cases"
    limit = f"by less than {np.degrees(modes.THRESHOLD):g} deg/s"
    why = f"{enough}, whose settled rates more modes would move {limit}"
    if chaotic:
        why = (
            f"{enough}. {chaotic} are chaotic: 1 um of clearance changes their settled rates by more "
            "than half. More modes would change their contacts by less than a tenth of the rates, and "
            f"would move the rates of the others {limit}"
        )
    return _with(ensemble, count, why)


def _with(ensemble: Ensemble, count: int, why: str) -> Ensemble:
    return ensemble._replace(numerics=replace(ensemble.numerics, modes=count), modes_why=why)


def _kept(ensemble: Ensemble, path: Path) -> Ensemble | None:
    """The ensemble with the number that an earlier pilot chose for the store at ``path``; None without
    such a store."""
    there = stores.described(path)
    if there is None or not there.get("modes_why"):
        return None
    found = _with(ensemble, there["identity"]["numerics"]["modes"], there["modes_why"])
    return found if stores.plain(found.identity()) == there["identity"] else None


def _chosen(ensemble: Ensemble, progress: Callable[[float], None]) -> list[Pilot]:
    """The pilot cases, without those that the scene refuses; as many at a time as there are processors."""
    source, found = ensemble.source, []
    last, count = source.asked - 1, min(PILOT, source.asked)
    numbers = np.linspace(0, last, count).round().astype(int).tolist()
    rows = [row for number in numbers for row in source.rows(number, number + 1)]
    progress(0.0)
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        for done, pilot in enumerate(pool.map(partial(_pilot, ensemble), rows), 1):
            found += [pilot] if pilot else []
            progress(done / count)
    return found


def _pilot(ensemble: Ensemble, row: Mapping[str, Any]) -> Pilot | None:
    """One pilot case; None if the scene refuses it."""
    numerics = ensemble.numerics.accurate()
    plain = replace(numerics, modes=0)
    try:
        scene = ensemble.scene.replace(row)
        if is_chaotic(ensemble, scene, plain):
            return Pilot(fewest_by_direct_effect(ensemble, scene, plain), True)
        run = solved(scene, ensemble.calibration, numerics, compliance=ensemble.compliance)
    except SceneError:
        return None
    return Pilot(int(run.numerics["modes"]), False)


def is_chaotic(ensemble: Ensemble, scene: Scene, numerics: Numerics) -> bool:
    """Whether 1 um more or less of every clearance changes a settled rate by more than half of the
    total rate, in runs with ``numerics``."""
    if ensemble.calibration is not None:  # its clearance is changed
        scene = ensemble.calibration.apply(scene)
    assert scene.contact is not None  # its rails may vibrate
    rates = []
    for change in ({}, *scene.contact.either_way(twins.CLEARANCE_CHANGE).values()):
        run = solved(scene.replace(change), None, numerics, compliance=ensemble.compliance)
        if run.outcome.rate is None:
            return False
        rates.append(np.array(run.outcome.rate))
    changed = max(np.abs(rate - rates[0]).max() for rate in rates)
    return bool(changed > _CHAOTIC * np.linalg.norm(rates[0]))


def fewest_by_direct_effect(ensemble: Ensemble, scene: Scene, numerics: Numerics) -> int:
    """The fewest modes for which the others would change the settled rates directly, without growth in
    later contacts, by at most a tenth of the total rate of a run with ``numerics``."""
    scene = ensemble.calibration.apply(scene) if ensemble.calibration is not None else scene
    spent = {"compile_s": 0.0, "compile_cpu_s": 0.0, "kernel_s": 0.0}
    run = integrated(SingleRun(scene, numerics, ensemble.compliance, watches=True), None, spent)
    rate = run.judged()[1].rate
    return (
        0 if rate is None else modes.needed(run.neglected(), _DIRECT * float(np.linalg.norm(rate)))
    )
