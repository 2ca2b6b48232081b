"""Closed forms, each with its citation, used by many tests."""
