"""Designs of rockets in files of other programs."""
