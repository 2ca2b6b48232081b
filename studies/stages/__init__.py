"""The stages of the pipeline, one file each: ``run(study) -> dict`` returns what the stage's result
file holds.

A stage asks for the stages it builds on, which answer at once when nothing changed.
"""
