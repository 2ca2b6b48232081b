"""Many varied cases of the surrogate, and what they say."""
