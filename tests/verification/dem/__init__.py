"""Verification of particles in space."""
