"""Checks of the options of ``tipoff limits``."""

from tipoff.comparison import order_statistics
from tipoff.mechanics.models import SPRINGS
from tipoff.scenes.faults import Fault, SceneError, together
from tipoff.studies.limits.options import Options
from tipoff.studies.populations import exceedance
from tipoff.studies.populations.exceedance import Limit
from tipoff.workspace.options import require

# times the fewest cases: some cases may then be above a limit
TIMES_NEEDED = 10
DRAWS = 8


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
    together(lambda: require(options), lambda: _draws(options))
    needed = order_statistics.runs_needed(options.probability, options.confidence)
    if options.cases is None:
        return TIMES_NEEDED * needed
    if options.cases >= needed:
        return options.cases
    expected = (
        f"{needed:,} or more, to show a probability of {options.probability:g} at a confidence of "
        f"{options.confidence:g}"
    )
    raise SceneError([Fault("--cases", "value", f"{options.cases:,}", expected)])


def _draws(options: Options) -> None:
    if options.draws is not None and options.draws >= 0 and options.model != SPRINGS:
        expected = (
            f"used only with --model {SPRINGS}; the constants of compliant contact are not drawn"
        )
        raise SceneError([Fault("--draws", "option", str(options.draws), expected)])
