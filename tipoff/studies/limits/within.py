"""Cases within tolerances. An input with tolerance T is normal about zero, or about its nominal value,
with T for three sigma. A value beyond T is drawn again, because an inspection would reject the part. An
error of thrust or mass has a uniform direction around the axis.

A case has the same draws for all sets of tolerances, so two sets do not differ by chance.

A tolerance of a file of errors is a multiple of the scatter that the file states (``scenes.halving``); its
cases have the distributions of the file.
"""

import json
import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff import sources
from tipoff.cache import Cache, binary
from tipoff.files import content_hash, labelled_netcdf
from tipoff.lowfi.ensemble import columns, pilot
from tipoff.lowfi.ensemble.derived import Derived, Numbers, around_zero, friction, law
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.lowfi.ensemble.threads import PIECE, completed
from tipoff.scenes import halving
from tipoff.scenes import overrides as keys
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.populations import answers
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.populations.random_factors import ERRORS, pointing
from tipoff.workspace.study import Study

CLEARANCE, FRICTION, TOGETHER = "clearance", "friction", "together"
# from the abstract of the paper
ADVISED = {
    "misalignment": math.radians(0.2),
    "thrust_eccentricity": 0.4e-3,
    "mass_eccentricity": 0.2e-3,
}
REACH = 5.0  # times the advised tolerances: up to the largest misalignment of the paper's sweep
SEED = 1  # of all draws of a search
PAIR = ("misalignment", "mass_eccentricity")
Source = Callable[[Scene, dict[str, float], int, int], Derived | Drawn]
"""Cases of a scene within tolerances by name, from their number and a seed."""


class Factor(NamedTuple):
    """A factor with a tolerance: ``words`` for a reader, the displayed ``unit`` and its size
    ``scale`` (SI), the largest searched tolerance ``most`` (SI), and the tolerance that the paper
    advises (SI), or None. Of a file of errors, tolerances are multiples: SI is one, and 1.0 is that of the
    file in place of an advised one."""

    words: str
    unit: str
    scale: float
    most: float
    advised: float | None


def factors(scene: Scene) -> dict[str, Factor]:
    """Every factor that ``scene`` has, by name."""
    found = {
        name: Factor(error.words, error.unit, error.scale, REACH * ADVISED[name], ADVISED[name])
        for name, error in ERRORS.items()
    }
    if scene.contact is not None and scene.contact.narrowest() > 0.0:
        found[CLEARANCE] = Factor(
            "clearance, about its nominal value", "mm", 1e-3, scene.contact.narrowest(), None
        )
    if scene.friction is not None and scene.friction.dynamic > 0.0:
        found[FRICTION] = Factor(
            "friction coefficient, about its nominal value", "1", 1.0, scene.friction.dynamic, None
        )
    return found


class Inputs(NamedTuple):
    """The ``factors`` whose tolerances are searched by name, the ``whole`` set that is scaled together by
    name, the ``source`` of its cases, the ``pair`` of a map, None without one, and 95 % of the values of a
    factor within a tolerance in ``words``; None if they are not from a file."""

    factors: dict[str, Factor]
    whole: dict[str, float]
    source: Source
    pair: tuple[str, str] | None = None
    words: Callable[[str, float], str] | None = None


def of_paper(scene: Scene) -> Inputs:
    """The factors of ``scene``; the set is that which the paper advises."""
    return Inputs(factors(scene), ADVISED, source, PAIR)


def of_file(errors: Uncertainty) -> Inputs:
    """The tolerances of a file of ``errors``, as multiples of those that it states."""
    names = list(halving.tolerances(errors))

    def words(name: str, multiple: float) -> str:
        return halving.words(halving.scaled(errors, {name: multiple}), name)

    return Inputs(
        {name: Factor(name, "times as stated", 1.0, REACH, 1.0) for name in names},
        dict.fromkeys(names, 1.0),
        partial(_of_file, errors),
        words=words,
    )


def _of_file(
    errors: Uncertainty, scene: Scene, multiples: dict[str, float], cases: int, seed: int
) -> Drawn:
    """Cases of ``errors`` with ``multiples`` of the tolerances by name. An input of another tolerance is
    that of the ``scene``; one that has no tolerance is that of the file."""
    scaled = halving.scaled(errors, multiples)
    every = halving.tolerances(errors)
    others = {key for name, own in every.items() if name not in multiples for key in own}
    factors_ = {key: keys.held(scene, key) for key in errors.factors}
    vary = {key: item for key, item in scaled.vary.items() if key not in others}
    return Drawn(Uncertainty(cases, seed, "random", vary, factors_))


def without_errors(model: Surrogate) -> Surrogate:
    """``model`` without errors of thrust and mass."""
    return model.at({f"{error.key}.axial": 0.0 for error in ERRORS.values()})


def source(scene: Scene, tolerances: dict[str, float], cases: int, seed: int) -> Derived:
    """Cases of ``scene`` within ``tolerances`` (SI) by name of a factor."""
    turn, unit = law("uniform", low=0.0, high=2.0 * math.pi), around_zero(1.0, "redraw")
    drawn = dict.fromkeys((*ERRORS, CLEARANCE, FRICTION), unit) | {
        f"{name} angle": turn for name in ERRORS
    }
    return Derived(
        Uncertainty(cases, seed, "random", drawn),
        lambda columns_: _overrides(scene, tolerances, columns_),
    )


def _overrides(scene: Scene, tolerances: dict[str, float], drawn: Numbers) -> Numbers:
    found: Numbers = {}
    for name, size in tolerances.items():
        if name in ERRORS:
            value, angle = pointing(size * drawn[name], drawn[f"{name} angle"])
            found |= {f"{ERRORS[name].key}.axial": value, f"{ERRORS[name].key}.radial": angle}
        elif name == CLEARANCE:
            assert scene.contact is not None
            found |= scene.contact.widened(size * drawn[name])
        else:
            assert scene.friction is not None
            found |= friction(scene, scene.friction.dynamic + size * drawn[name])
    return found


def with_modes(model: Surrogate, drawn: Derived | Drawn) -> Surrogate:
    """``model`` with the number of rail modes that pilot cases of ``drawn`` choose."""
    return model.with_modes_of(pilot.settled(model.ensemble(drawn)))


class CasesAtScale:
    """Results of ``model`` within ``tolerances`` (SI) of a ``source`` times a scale; each scale is run once and
    kept in a file. The model has one number of modes for all scales (``with_modes``): otherwise the
    number of cases above a limit would jump."""

    def __init__(
        self,
        study: Study,
        folder: str,
        model: Surrogate,
        tolerances: dict[str, float],
        cases: int,
        seed: int,
        source: Source = source,
    ):
        self._study, self._folder, self._model, self._tolerances = study, folder, model, tolerances
        self._cases, self._seed, self._source = cases, seed, source
        self._known: dict[float, np.ndarray] = {}

    def source(self, scale: float) -> Derived | Drawn:
        """The cases at a scale; a single case at scale zero, where all cases are equal."""
        sizes = {name: scale * size for name, size in self._tolerances.items()}
        count = self._cases if scale > 0.0 else 1
        return self._source(self._model.scene, sizes, count, self._seed)

    def values(self, scale: float) -> np.ndarray:
        """The quantities (n,k) of ``answers.ALL``; NaN in cases that did not settle."""
        if scale not in self._known:
            self._known[scale] = np.broadcast_to(self._run(scale), (self._cases, len(answers.ALL)))
        return self._known[scale]

    def rates(self, scale: float) -> np.ndarray:
        """Rates (n,3), deg/s."""
        return self.values(scale)[:, : len(answers.RATES)]

    def _run(self, scale: float) -> np.ndarray:
        drawn = self.source(scale)
        ensemble = self._model.ensemble(drawn)
        key = content_hash(ensemble.key, self._model.instant.at, sources.digest(answers.__name__))
        path = self._study.path(f"{self._folder}/{key[:16]}.nc")

        def make() -> np.ndarray:
            pieces = (
                drawn.rows(begin, min(begin + PIECE, drawn.asked))
                for begin in range(0, drawn.asked, PIECE)
            )
            workers = self._study.settings.workers
            found = columns.of_cases(
                [case for piece in completed(ensemble.family(), pieces, workers) for case in piece]
            )
            shown = columns.seen(found, self._model.instant.at)
            return np.column_stack([quantity.of(shown) for quantity in answers.ALL])

        sizes = {name: scale * size for name, size in self._tolerances.items()}
        return kept(scale, sizes).get_or_make(path, key, "its cases are run again", make)


def kept(scale: float, tolerances: Mapping[str, float]) -> Cache[np.ndarray]:
    """Cache of values (n,k) of ``answers.ALL``, with ``scale`` and the ``tolerances`` (SI) at that
    scale as attributes of each file."""
    return binary(lambda values: _content(values, scale, tolerances), _load)


def _content(values: np.ndarray, scale: float, tolerances: Mapping[str, float]) -> memoryview:
    return labelled_netcdf(
        {
            "case": (("case",), np.arange(len(values)), {}),
            "quantity": (("quantity",), [item.name for item in answers.ALL], {}),
            "units": (("quantity",), [item.unit for item in answers.ALL], {}),
            "value": (
                ("case", "quantity"),
                values,
                {
                    "long_name": "quantity of a case after the exit, NaN where it did not settle",
                    "coordinates": "units",
                },
            ),
        },
        {"scale": scale, "tolerances_si": json.dumps(dict(tolerances))},
    )


def _load(path: Path) -> np.ndarray:
    import h5py  # slow to load

    with h5py.File(path) as found:
        return found["value"][:]
