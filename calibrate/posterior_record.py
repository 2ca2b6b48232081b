"""Draws from the posterior of a calibration, with what they say: data only, as the stage ``posterior`` writes it."""

import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Posterior:
    """Plain values in SI, lists over p ``parameters`` (``units``, ``lower`` and ``upper`` bounds, whether the prior is uniform in
    the logarithm, ``best`` as calibrated, ``median``).

    ``intervals``: 95 %, with the discrepancy, None where the posterior is the prior; ``without``: linear ones that take every
    sample for independent noise. ``spread``: standard deviations over the prior's; ``notes``: sentences on what is not told;
    ``correlation`` (p,p) of the shares of the bounds. ``errors``: the discrepancy of each quantity; ``chain``: how the draws were
    made, and ``doubts`` about them; ``profile``: by parameter, values and how far the log likelihood drops. ``draws``: k dotted
    overrides, as columns by key; ``samples``: the same as parameters. ``settled_size`` (k,3): size of the discrepancy of settled
    rates relative to |w_s|, for a t of ``settled_freedom`` degrees of freedom.
    """

    parameters: list[str]
    units: list[str]
    lower: list[float]
    upper: list[float]
    logarithmic: list[bool]
    best: list[float]
    median: list[float]
    intervals: list[list[float] | None]
    without: list[list[float] | None]
    spread: list[float]
    notes: list[str]
    correlation: list[list[float]]
    conditions: list[str]
    errors: dict
    chain: dict
    profile: dict
    draws: dict[str, list[float]]
    samples: dict[str, list[float]]
    settled_size: list[list[float]]
    settled_freedom: float

    def as_dict(self) -> dict:
        """Plain values for a result file."""
        return asdict(self)

    @classmethod
    def load(cls, path: str | Path) -> "Posterior":
        """Read ``posterior.json``. Raises FileNotFoundError, or ValueError for a damaged or foreign file."""
        try:
            data = json.loads(Path(path).read_text(encoding="utf-8"))
            return cls(**{item.name: data[item.name] for item in fields(cls)})
        except (ValueError, TypeError, KeyError) as error:
            raise ValueError(f"{path}: not a posterior ({error})") from error


def draws(posterior: Posterior, count: int | None = None, seed: int = 0) -> list[dict[str, float]]:
    """``count`` draws (absent: all) of the calibrated constants, as dotted overrides in SI: rows for ``lowfi.run_many`` or
    arguments of ``Scene.replace``. Without replacement as long as there are enough; the same seed gives the same draws."""
    return [{key: values[index] for key, values in posterior.draws.items()} for index in chosen(posterior, count, seed)]


def chosen(posterior: Posterior, count: int | None = None, seed: int = 0) -> np.ndarray:
    """Numbers (count,) of the draws that ``draws`` gives for the same arguments."""
    there = len(posterior.settled_size)
    if count is None:
        return np.arange(there)
    return np.random.default_rng(seed).choice(there, count, replace=count > there)


def disturbed(posterior: Posterior, rates: np.ndarray, numbers: np.ndarray | None = None, seed: int = 0) -> np.ndarray:
    """Settled rates (k,...,3) of the draws ``numbers`` (k,), absent: all of them, with the discrepancy added, as the reference
    might have them."""
    numbers = chosen(posterior) if numbers is None else numbers
    size = np.array(posterior.settled_size)[numbers].reshape(len(numbers), *[1] * (rates.ndim - 2), 3)
    fresh = np.random.default_rng([seed, 2]).standard_t(posterior.settled_freedom, rates.shape)
    return rates + np.linalg.norm(rates, axis=-1, keepdims=True) * size * fresh
