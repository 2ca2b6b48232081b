"""The report: one self-contained page, and every figure as a PNG beside it."""
