"""Interruption and restart of studies."""
