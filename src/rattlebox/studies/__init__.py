"""Studies: many cases at once."""
