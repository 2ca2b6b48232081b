"""A scene under study: stages, stored runs, settings and models."""
