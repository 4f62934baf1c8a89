"""Calibration: contact parameters from measurements, with intervals."""
