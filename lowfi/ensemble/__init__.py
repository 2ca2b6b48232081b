"""Many runs at once: where cases come from, how they run, where results are kept."""
