"""Tests of the scene, its effects, and the records that travel."""
