"""Values of sets of tolerances that are not written: writing takes longer than finding them."""

from tests.in_memory import memory
from tipoff.studies.limits import within


def keep(patch, written: int = 0) -> None:
    """Keep the values of all sets in memory. The first ``written`` of them become files too."""
    kept, files = {}, within.kept
    patch.setattr(within, "kept", lambda *of: memory(kept, files(*of), written))
