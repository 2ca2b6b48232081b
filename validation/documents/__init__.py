"""Writers of README and of pages of the documentation from stored results."""
