"""A scene under study: its stages, stored runs, settings and models."""
