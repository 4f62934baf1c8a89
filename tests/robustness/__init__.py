"""Robustness: bad input, damaged files, interruptions, full disks and random cases."""
