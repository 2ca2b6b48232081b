"""Stubbed runs of the convergence study, whose rates follow a law."""

import math
from dataclasses import replace

import numpy as np
from pydantic_core import to_jsonable_python

from tests.studies import kept
from tests.studies.synthetic import COSTS, flight
from tipoff import scenes
from tipoff.studies.convergence.stage import STAGE

SURROGATE_ERROR = 1.2  # deg/s
NOMINAL_INTERFACE_STIFFNESS = scenes.load("tiny").contact.interface_stiffness


def settled(run):
    """Rates (deg/s): x errs with the square of the element size (mm) and of the step, y jumps to
    and fro, z never changes; the surrogate is off by ``SURROGATE_ERROR`` from the finest mesh."""
    if run.fidelity == "lowfi":
        return 3.0 + 1e-3 * 16.0 + 0.1 * 0.9**2 + SURROGATE_ERROR, 1.0, 2.0
    size, dt = 1e3 * run.numerics.element_size, step(run)
    interface_stiffness = (
        run.scene.contact.interface_stiffness / NOMINAL_INTERFACE_STIFFNESS
        if run.scene.contact
        else 1.0
    )
    return (
        3.0 + 1e-3 * size**2 + 0.1 * dt**2 + 0.01 * math.log2(interface_stiffness),
        {8.0: 1.3}.get(size, 1.0),
        2.0,
    )


def step(run):
    """The step (s), as if the limit were 1 s."""
    return run.numerics.safety if run.fidelity == "highfi" else 1.0


def motion(run, **parts):
    force = np.zeros((601, 16, 3))
    if run.scene.contact:
        force[:, 2, 1] = 20.0
    cost = COSTS | {"dt_s": step(run)}
    return flight(
        lambda t: np.tile(np.radians(settled(run)), (t.size, 1)),
        pad_force=force,
        cost=cost,
        **parts,
    )


def resting(scene, sizes):
    """A deflection that errs with the size itself; none without contact."""
    if scene.contact:
        yield "deflection under 100 N", "µm", [10.0 - 100.0 * size for size in sizes]


def row(found, parameter, quantity):
    (matching,) = [
        item
        for item in found.quantities
        if (item.parameter, item.quantity) == (parameter, quantity)
    ]
    return matching


def document(*, speed=None, equal=None):
    """The result of ``tiny`` as the content of its file, with a settled ``speed`` of known uncertainty
    alone, and the speed-up at ``equal`` accuracy."""
    found = kept.result(STAGE)
    known = replace(
        row(found, "element size", "settled axial velocity"),
        uncertainty=speed,
        nominal_uncertainty=speed,
    )
    rows = () if speed is None else (known,)
    asked = replace(found, condition="phi60", quantities=rows, equal_accuracy=equal)
    return to_jsonable_python(asked)
