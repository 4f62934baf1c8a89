"""Verification of the 3-D engine."""
