"""Figures of runs and studies, and their common style, which can be used for other figures."""

from .backbone import plot_backbone
from .basins import plot_basins
from .bifurcation import plot_bifurcation
from .branches import plot_branches
from .calibration import plot_calibration
from .case import plot_case
from .compare import plot_comparison
from .damping_curve import plot_damping_curve
from .design import plot_design
from .energy import plot_energy
from .impacts import plot_impacts
from .loss_map import plot_loss_map
from .lyapunov import plot_lyapunov
from .map_response import plot_response_from_map
from .maps import plot_map
from .motion import plot_motion
from .orbits import plot_orbit
from .particles import film_particles, plot_particles
from .phase import plot_phase_portrait
from .response import plot_frequency_response
from .responses import plot_responses
from .sensitivity import plot_sensitivity
from .spectra import plot_psd, plot_shock_spectrum, plot_third_octaves
from .stability_lobes import plot_stability_lobes
from .style import (
    CHANNEL_COLOURS,
    FAINT,
    INK,
    SERIES_COLOURS,
    SERIES_MARKERS,
    SERIES_STYLES,
    StyledFigure,
    figure_style,
    label,
    legend_above,
    pen,
    scaled,
)

__all__ = [
    "CHANNEL_COLOURS",
    "FAINT",
    "INK",
    "SERIES_COLOURS",
    "SERIES_MARKERS",
    "SERIES_STYLES",
    "StyledFigure",
    "figure_style",
    "film_particles",
    "label",
    "legend_above",
    "pen",
    "plot_backbone",
    "plot_basins",
    "plot_bifurcation",
    "plot_branches",
    "plot_calibration",
    "plot_case",
    "plot_comparison",
    "plot_damping_curve",
    "plot_design",
    "plot_energy",
    "plot_frequency_response",
    "plot_impacts",
    "plot_loss_map",
    "plot_lyapunov",
    "plot_map",
    "plot_motion",
    "plot_orbit",
    "plot_particles",
    "plot_phase_portrait",
    "plot_psd",
    "plot_response_from_map",
    "plot_responses",
    "plot_sensitivity",
    "plot_shock_spectrum",
    "plot_stability_lobes",
    "plot_third_octaves",
    "scaled",
]
