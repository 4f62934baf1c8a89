"""Functions of runs and of sampled signals: spectra, portraits, decay, measures, energy, chaos."""

from .chaos import lyapunov_exponent
from .decay import damping_ratio, decay_envelope
from .energy import complex_power, energy_shares, loss_factor, specific_damping_capacity
from .granular import shaken_cavity
from .measures import peak_reduction, rms_reduction, settling_time
from .sections import impacts_per_cycle, phase_portrait, poincare_section
from .spectra import amplitude_spectrum

__all__ = [
    "amplitude_spectrum",
    "complex_power",
    "damping_ratio",
    "decay_envelope",
    "energy_shares",
    "impacts_per_cycle",
    "loss_factor",
    "lyapunov_exponent",
    "peak_reduction",
    "phase_portrait",
    "poincare_section",
    "rms_reduction",
    "settling_time",
    "shaken_cavity",
    "specific_damping_capacity",
]
