"""The rattlebox command."""
