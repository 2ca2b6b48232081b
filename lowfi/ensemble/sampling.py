"""Points of the unit cube by case number: plain sampling, Latin hypercube, scrambled Sobol'. Case n
has the same bits for any division into chunks.

Plain sampling takes 52 bits per number from the counter-based generator Philox (Salmon et al., SC
2011), keyed by the seed, with the case as its counter, so every case costs the same. Sobol'
(``scipy.stats.qmc``) is advanced to the case. A Latin hypercube exists only as a whole and is held
in memory.
"""

import warnings

import numpy as np
import scipy  # its submodules load at their first use

from tipoff.faults import Fault, SceneError
from tipoff.scenes.uncertainty import Uncertainty

# numbers of a Latin hypercube: 128 MiB, and three times as much during its creation
MOST_HELD = 2**24
_WORDS = 4  # 64-bit words that Philox makes per count
_SOBOL_BITS = 32  # SciPy cannot advance longer sequences
_EDGE = 2.0**-53  # a normal distribution has no finite quantile at 0 and 1


class Points:
    """Points of ``uncertainty`` in the open unit cube, one dimension per varied key.

    Raises SceneError for a Latin hypercube that is too large for memory, and for more dimensions
    than Sobol' has.
    """

    def __init__(self, uncertainty: Uncertainty):
        self._seed, self._size = uncertainty.seed, len(uncertainty.vary)
        self._draw = {
            "random": self._random,
            "latin-hypercube": self._hypercube,
            "sobol": self._sobol,
        }[uncertainty.sampling]
        if uncertainty.sampling == "latin-hypercube":
            if uncertainty.cases * self._size > MOST_HELD:
                raise SceneError(
                    [
                        Fault(
                            "vary",
                            "sampling",
                            f"latin-hypercube of {uncertainty.cases:,} cases and {self._size} keys",
                            f"at most {MOST_HELD // self._size:,} cases, for it is held in memory, "
                            "or random or sobol",
                        )
                    ]
                )
            self._held = scipy.stats.qmc.LatinHypercube(
                self._size, rng=np.random.default_rng(self._seed)
            ).random(uncertainty.cases)
        if uncertainty.sampling == "sobol":
            if self._size > scipy.stats.qmc.Sobol.MAXDIM or uncertainty.cases > 2**_SOBOL_BITS:
                raise SceneError(
                    [
                        Fault(
                            "vary",
                            "sampling",
                            f"sobol of {uncertainty.cases:,} cases and {self._size:,} keys",
                            f"at most {2**_SOBOL_BITS:,} cases and "
                            f"{scipy.stats.qmc.Sobol.MAXDIM:,} keys",
                        )
                    ]
                )
            self._engine = scipy.stats.qmc.Sobol(
                self._size, bits=_SOBOL_BITS, rng=np.random.default_rng(self._seed)
            )

    def draw(self, begin: int, end: int) -> np.ndarray:
        """Points (end - begin, d) of the cases ``begin`` to ``end`` - 1."""
        return np.clip(self._draw(begin, end), _EDGE, 1.0 - _EDGE)

    def _random(self, begin: int, end: int) -> np.ndarray:
        counts = -(-self._size // _WORDS)
        words = np.random.Philox(key=self._seed, counter=begin * counts).random_raw(
            (end - begin) * counts * _WORDS
        )
        return (words.reshape(end - begin, -1)[:, : self._size] >> np.uint64(12)) * 2.0**-52

    def _hypercube(self, begin: int, end: int) -> np.ndarray:
        return self._held[begin:end]

    def _sobol(self, begin: int, end: int) -> np.ndarray:
        engine = self._engine
        if begin < engine.num_generated:
            engine.reset()
        if begin > engine.num_generated:
            engine.fast_forward(begin - engine.num_generated)
        with warnings.catch_warnings():
            # Balance needs a power of two as the number of all cases, not of this chunk; the
            # summary states it once.
            warnings.filterwarnings("ignore", "The balance properties", UserWarning)
            # middles of the cells: a normal law has no quantile at zero
            return engine.random(end - begin) + 0.5 ** (_SOBOL_BITS + 1)
