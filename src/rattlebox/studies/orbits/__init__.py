"""Periodic motions: search, stability, continuation in a parameter, and their bifurcations."""
