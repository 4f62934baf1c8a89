"""Kinds of studies, one module each."""

KINDS = "sweep", "bifurcation", "frequency_response", "basins", "lyapunov", "loss_map", "design", "sensitivity"
"""Names of the kinds: of their module, their function and the key `kind` of their study file."""
