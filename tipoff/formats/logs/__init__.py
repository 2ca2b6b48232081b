"""Logs of sensors: tables of text whose columns a sheet names."""
