"""Exact solutions from formulas alone; nothing here imports rattlebox."""
