"""Axes, parameters and samples: which variants a study has."""
