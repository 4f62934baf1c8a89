"""Independent program for motions in 113-bit arithmetic, and the runs that it computed."""
