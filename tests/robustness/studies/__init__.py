"""Studies that are stopped, killed, resumed, refused."""
