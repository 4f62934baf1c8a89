"""Helpers without physics, used by all other parts of the package."""
