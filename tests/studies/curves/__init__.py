"""Curves of other codes against each other and against tipoff."""
