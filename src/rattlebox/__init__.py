"""Simulator and design tool for particle and impact dampers."""
