"""Readers: files of other programs as plain arrays, with the units that they state."""
