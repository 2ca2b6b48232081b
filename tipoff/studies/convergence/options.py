"""Options of ``tipoff convergence``."""

from dataclasses import dataclass

from tipoff.studies.commands.options import RefinedCondition


@dataclass(frozen=True)
class ConvergenceOptions:
    """``condition`` None: the first refined one of the scene, or else the first one."""

    condition: RefinedCondition = None
