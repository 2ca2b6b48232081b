"""Curves over time that other codes and tests write. ``reader`` is the entry."""
