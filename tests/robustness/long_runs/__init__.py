"""Long runs of particles that are stopped, killed, resumed, refused."""
