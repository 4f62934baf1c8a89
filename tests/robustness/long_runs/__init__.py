"""Interruption and restart of runs with particles."""
