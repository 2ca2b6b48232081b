"""Figures of the thrust for the page: impulse, cutoff, fit of a measured curve."""

import math

import numpy as np

from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes.effects.measured import GaussianFit
from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.effects.thrust import GaussiansTable, GaussianTable
from tipoff.scenes.scene import Scene
from tipoff.studies.render.table import Table
from tipoff.units import duration


def thrust_facts(scene: Scene) -> Table:
    """Impulse, its share outside the duration or the cutoff, and the fit of a measured curve."""
    if isinstance(scene.thrust, PushedTable):
        return Table(("thrust", ""), [("springs", scene.thrust.words())])
    record = scene.thrust.record()
    delivered = thrust_law.impulse(record, scene.time_limit)
    rows = [
        ("impulse delivered within the scene", f"{delivered:.6g} N s"),
        ("velocity change of the payload alone", f"{delivered / scene.payload.mass:.5g} m/s"),
        ("thrust at ignition", f"{thrust_law.sample(record, np.zeros(1))[0]:.4g} N"),
    ]
    if record.pulses is not None:
        p = record.pulses
        whole = float((p.peaks * p.widths).sum() * math.sqrt(2.0 * math.pi))
        words = f"{whole:.6g} N s"
        if whole:
            words += (
                f", of which {100.0 * (1.0 - delivered / whole):.3g} % falls before ignition, after "
                "the end, or beyond the cutoff"
            )
        rows.append(("impulse of the whole Gaussian", words))
        cut = "none"
        if isinstance(scene.thrust, (GaussianTable, GaussiansTable)) and scene.thrust.cutoff:
            kept = "rescaled" if scene.thrust.rescale else "not rescaled"
            cut = f"{scene.thrust.cutoff:g} widths, {kept}"
        rows.append(("cutoff", cut))
    if scene.thrust.kind == "measured":
        rows += [("file", "; ".join(notes))] if (notes := scene.thrust.notes()) else []
        rows.append(("Gaussian fit of the measured curve", _fit(scene.thrust.fit())))
    return Table(("thrust", ""), rows)


def _fit(fit: GaussianFit | None) -> str:
    if fit is None:
        return "none fits"
    return (
        f"peak {fit.peak:.5g} N at {duration(fit.centre, 4)}, width {duration(fit.width, 4)}, "
        f"impulse {fit.impulse:.5g} N s against {fit.curve_impulse:.5g} N s of the curve, "
        f"residual {100.0 * fit.relative_residual:.3g} %"
    )
