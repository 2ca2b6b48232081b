"""Values of sets of tolerances that are not written: writing takes longer than finding them."""

from tests.in_memory import memory
from tipoff.studies.limits import results


def keep(patch, written: int = 0) -> None:
    """Keep the values of all sets in memory. The first ``written`` of them become files too."""
    kept, files = {}, results.kept
    patch.setattr(results, "kept", lambda *of: memory(kept, files(*of), written))
