"""What is computed before a run: settled packings, softening, the time step, and the numbers that the core reads."""
