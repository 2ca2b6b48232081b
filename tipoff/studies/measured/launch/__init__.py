"""Launches from rest on a rail: the log reduced, its uncertainty, and its place among predicted launches."""
