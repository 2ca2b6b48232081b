"""Settings every test shares: pictures are drawn without a display.

The directory of compiled kernels is chosen by `scenes.jit`, for tests and runs alike.
"""

import os

os.environ.setdefault("MPLBACKEND", "Agg")
