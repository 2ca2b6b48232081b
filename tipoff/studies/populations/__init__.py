"""Populations of cases: random inputs, results, and statistics of independent draws."""
