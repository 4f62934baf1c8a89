"""Functions of runs and of sampled signals: spectra, portraits, decay, measures, energy, chaos."""

from rattlebox._util.batch_means import Interval, mean_interval
from rattlebox.results.extremes import largest_acceleration, largest_drift
from rattlebox.results.wall_measures import wall_pressures, wall_wear

from .chaos import lyapunov_exponent
from .chatter import minimum_real_part
from .damping_curve import damping_over_amplitude, equivalent_damping
from .decay import damping_ratio, decay_envelope
from .drift import drift
from .energy import complex_power, energy_shares, loss_factor, specific_damping_capacity
from .measured import read_frequency_response
from .measures import peak_reduction, rms_reduction, settling_time
from .modal_estimates import Resonance, circle_fit, damping_as, frequency_response_as, half_power
from .notching import Notched, apparent_mass, notch
from .over_records import over_records
from .power_spectra import (
    band_levels,
    miles_rms,
    power_spectral_density,
    transfer_function,
    transmissibility,
)
from .sections import impacts_per_cycle, phase_portrait, poincare_section
from .shaken import shaken_cavity
from .shock import shock_response_spectrum
from .spectra import amplitude_spectrum

__all__ = [
    "Interval",
    "Notched",
    "Resonance",
    "amplitude_spectrum",
    "apparent_mass",
    "band_levels",
    "circle_fit",
    "complex_power",
    "damping_as",
    "damping_over_amplitude",
    "damping_ratio",
    "decay_envelope",
    "drift",
    "energy_shares",
    "equivalent_damping",
    "frequency_response_as",
    "half_power",
    "impacts_per_cycle",
    "largest_acceleration",
    "largest_drift",
    "loss_factor",
    "lyapunov_exponent",
    "mean_interval",
    "miles_rms",
    "minimum_real_part",
    "notch",
    "over_records",
    "peak_reduction",
    "phase_portrait",
    "poincare_section",
    "power_spectral_density",
    "read_frequency_response",
    "rms_reduction",
    "settling_time",
    "shaken_cavity",
    "shock_response_spectrum",
    "specific_damping_capacity",
    "transfer_function",
    "transmissibility",
    "wall_pressures",
    "wall_wear",
]
