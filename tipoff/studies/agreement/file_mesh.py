"""The change of the reference by its mesh where a file gives the same mesh for both element sizes: it
cannot be coarsened, so its elements are split once more.

Then the change from h to h/2 is known instead of that from 2h to h. Where the error falls with the
first power of h, as at the edge of a clamp, it is half as large, and what is left at h is twice the
change: twice the change is taken. Where the finer mesh does not fit into memory, or its run would
take too long, the change is not known.
"""

from dataclasses import replace

from tipoff.studies.agreement.verdicts import Spread, spread
from tipoff.studies.core.progress import say
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study

_CAUSE = "mesh"
_FIRST_ORDER = 2.0


def spreads(study: Study) -> list[Spread]:
    """Spread of the reference by the mesh, one a condition whose coarse mesh is its own."""
    found, pairs = [], {}
    for name in study.conditions:
        size = _only_size(study, name)
        if size is None:
            continue
        if (finer := _finer(study, name, 0.5 * size)) is None:
            found.append(Spread(name, "reference", _CAUSE, None, None))
        else:
            pairs[name] = [study.highfi(name), finer]
    runs = study.store.fill("finer mesh", [run for pair in pairs.values() for run in pair])
    for name in pairs:
        own, finer_run = runs.pop(0), runs.pop(0)
        changed = spread(name, "reference", _CAUSE, own, [finer_run])
        found.append(
            replace(
                changed,
                rate_relative_l2=_scaled(changed.rate_relative_l2),
                settled_rate_change_deg_s=_scaled(changed.settled_rate_change_deg_s),
            )
        )
    return found


def _only_size(study: Study, name: str) -> float | None:
    """Size (m) of the elements of the one mesh that both element sizes give; None for two."""
    from tipoff.highfi.rail import refinement

    settings = study.settings
    coarse, own = refinement.sizes(
        study.condition(name), (settings.coarse_size, settings.element_size)
    )
    return own if coarse == own else None


def _finer(study: Study, name: str, size: float) -> Run | None:
    """A run in elements of ``size`` (m), or None where that asks too much."""
    from tipoff.highfi.rail import refinement

    if reason := refinement.too_fine(study.condition(name), size):
        say(f"  {name}: convergence by the mesh is not known: {reason}")
        return None
    return study.highfi(name, tag="-finer", element_size=size)


def _scaled(change: float | None) -> float | None:
    return None if change is None else _FIRST_ORDER * change
