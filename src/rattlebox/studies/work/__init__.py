"""Computation of the variants: engine, order and reduction."""
