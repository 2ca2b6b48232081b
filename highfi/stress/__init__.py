"""Stress of the rails while a run goes on."""
