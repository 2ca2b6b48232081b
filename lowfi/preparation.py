"""Set-up of the time loop: of one run, and of the cases of an ensemble that share a call."""

from collections.abc import Sequence
from typing import NamedTuple

from tipoff.lowfi import system
from tipoff.lowfi.contact import thermal_offset
from tipoff.lowfi.contact.compliant import neglected, record
from tipoff.lowfi.dynamics import cases, integrate, local_error, plan, settle
from tipoff.lowfi.dynamics.loop import Loop, Plan
from tipoff.lowfi.models import require_walls
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.model import Model
from tipoff.mechanics.outcome import Milestones
from tipoff.mechanics.promises import Promises
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import settled
from tipoff.scenes.effects.friction import require_two_step
from tipoff.scenes.rail_compliance import of_scene, require_modes
from tipoff.scenes.scene import Scene


class Prepared(NamedTuple):
    """Arguments of ``integrate.integrate``, without the samples."""

    system: system.System
    plan: Plan
    tolerance: local_error.Tolerance
    marks: Milestones
    loop: Loop
    cases: cases.Cases


def prepare(
    scene: Scene,
    models: Sequence[Model],
    marks: Milestones,
    numerics: Numerics,
    promised: Promises,
    compliance: RailCompliance | None = None,
    watches: bool = False,
) -> Prepared:
    """The time loop for one case of each of the ``models``, which differ from that of ``scene`` only
    in the values of ``cases.Cases``. Steps are those of ``numerics``, errors of the ledgers those
    ``promised``. A run without modes that ``watches`` them finds their effect. Raises SceneError if
    ``compliance`` is of another rail or lacks what the scene needs."""
    settled.require(scene)
    model, modes = models[0], numerics.count
    require_walls(scene, compliance)
    found = of_scene(compliance, scene) if compliance and scene.contact else None
    found = found.of_degree(numerics.known_degree or found.degree) if found else None
    damping = scene.rail.damping.record() if scene.rail.damping is not None else None
    pressed = None
    if found is not None and found.flexibility is not None:
        require_two_step(scene)
        require_modes(scene.name, found, modes)
        pressed = record.build(found, model, cells=numerics.cells, modes=modes, damping=damping)
    common = system.build(
        model,
        compliance=pressed,
        thermal_offset=thermal_offset.under_pads(model, found),
        neglected=neglected.watched(found, damping, pressed, watches),
    )
    steps, every = plan.make(model, scene.time_limit, numerics), cases.of_models(common, models)
    if model.initial.settled:
        assert len(models) == 1
        every = every._replace(start=settle.rest(scene.name, common, every, model)[None])
    return Prepared(
        system=common,
        plan=steps,
        tolerance=local_error.tolerance(numerics, promised),
        marks=marks,
        loop=integrate.ready(common, every.start[0], steps.first),
        cases=every,
    )
