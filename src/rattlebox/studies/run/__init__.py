"""Blocks on threads, processes or a cluster, and the stores that hold them."""
