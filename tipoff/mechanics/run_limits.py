"""Times and numbers that bound a run and its windows."""

LONGEST = 3600.0  # s, of a run
MOST_SAMPLES = 1_000_000  # after ignition: a gigabyte of curves
EXIT_WINDOW = 2e-4  # s, from the exit on
SETTLE_DELAY = 1e-3  # s, from the exit to the settled window
SETTLE_WINDOW = 2e-3  # s
JAM_DURATION = 5e-3  # s
SLOW = 0.01  # m/s, where friction has no transition speed
