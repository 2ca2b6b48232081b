"""Settings every test shares: pictures are drawn without a display, and property tests draw the same examples each time.

The directory of compiled kernels is chosen by `scenes.jit`, for tests and runs alike. To look for new examples, run pytest with
`--hypothesis-profile=explore`.
"""

import os

from hypothesis import settings

os.environ.setdefault("MPLBACKEND", "Agg")
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None)
settings.load_profile("repeatable")
