"""The options of ``tipoff limits`` and their checks."""

from dataclasses import dataclass

from tipoff.comparison import order_statistics
from tipoff.mechanics.models import SPRINGS
from tipoff.scenes.faults import Fault, SceneError, together
from tipoff.studies.populations import exceedance
from tipoff.studies.populations.exceedance import Limit

# times the fewest cases: some cases may then be above a limit
TIMES_NEEDED = 10
DRAWS, _MOST_DRAWS = 8, 1000
_FEWEST_RUNS = 20  # of the reference: with fewer, a bound says nothing


@dataclass(frozen=True)
class Options:
    """``limits`` in the form of ``exceedance.limits``; the ``probability`` with which a case keeps
    all of them, at a ``confidence``, from a number of ``cases`` (None: ten times the fewest);
    ``tolerances`` that are scaled together, "advised" or "table3"; ``others``, errors that do not
    vary, as in the "scene" or "zero"; ``draws`` of the calibrated constants, for springs alone
    (None: eight); name of the ``model`` (None: the default); name of a ``condition`` (None: the
    scene); number of runs of the reference that ``certify`` the result (None: none)."""

    limits: tuple[str, ...] = ("5 deg/s",)
    probability: float = 0.99
    confidence: float = 0.95
    cases: int | None = None
    seed: int = 1
    tolerances: str = "advised"
    others: str = "scene"
    draws: int | None = None
    model: str | None = None
    condition: str | None = None
    certify: int | None = None


def checked(options: Options) -> tuple[list[Limit], int]:
    """Limits and number of cases. Raises SceneError listing every fault."""
    return tuple(together(lambda: _limits(options.limits), lambda: _cases(options)))


def _limits(texts: tuple[str, ...]) -> list[Limit]:
    found = exceedance.limits(texts)
    axes = [limit.axis for limit in found]
    if twice := sorted({axis for axis in axes if axes.count(axis) > 1}):
        raise SceneError(
            [Fault("--limit", axis, "two limits", "one limit for a rate") for axis in twice]
        )
    return found


def _cases(options: Options) -> int:
    faults = []
    if not 0.5 <= options.probability < 1.0:
        faults.append(
            Fault(
                "--probability", "value", f"{options.probability:g}", "0.5 or more and less than 1"
            )
        )
    if not 0.5 <= options.confidence < 1.0:
        faults.append(
            Fault("--confidence", "value", f"{options.confidence:g}", "0.5 or more and less than 1")
        )
    if options.certify is not None and options.certify < _FEWEST_RUNS:
        expected = f"{_FEWEST_RUNS} or more runs"
        faults.append(Fault("--certify", "value", str(options.certify), expected))
    if options.draws is not None and options.model != SPRINGS:
        expected = (
            f"used only with --model {SPRINGS}; the constants of compliant contact are not drawn"
        )
        faults.append(Fault("--draws", "option", str(options.draws), expected))
    elif options.draws is not None and not 0 <= options.draws <= _MOST_DRAWS:
        faults.append(Fault("--draws", "value", str(options.draws), f"0 to {_MOST_DRAWS}"))
    if not faults:
        needed = order_statistics.runs_needed(options.probability, options.confidence)
        if options.cases is None:
            return TIMES_NEEDED * needed
        if options.cases >= needed:
            return options.cases
        faults.append(
            Fault(
                "--cases",
                "value",
                f"{options.cases:,}",
                f"{needed:,} or more, to show a probability of {options.probability:g} at a "
                f"confidence of {options.confidence:g}",
            )
        )
    raise SceneError(faults)
