"""Hard cases, each beside a weaker method that fails on it."""
