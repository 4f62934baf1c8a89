"""Golden results of both engines: bits, values and statistics."""
