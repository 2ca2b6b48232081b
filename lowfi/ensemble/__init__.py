"""Many runs at once: sources of cases, their computation, and the store of their results."""
