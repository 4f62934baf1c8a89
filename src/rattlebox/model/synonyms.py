"""What other programs and books call things, for suggestions where a name is not known."""

_OTHERS = {  # ours: others'
    # fields
    "stiffness K": "k",
    "damping C": "c",
    "mass M": "m",
    "damping_ratio damping_ratios": "zeta xi modal_damping damping_factor",
    "damping": "damping_ratio",
    "e restitution": "e cor coefficient_of_restitution",
    "friction coefficient": "mu friction_coefficient coefficient_of_friction sliding_friction",
    "rolling coefficient": "mu_r rolling_friction rolling_resistance",
    "count": "n number amount num quantity",
    "fill_ratio": "fill filling packing_fraction volume_fraction",
    "gravity": "g",
    "young": "E youngs_modulus young_modulus elastic_modulus modulus",
    "poisson": "nu poissons_ratio poisson_ratio",
    "density": "rho",
    "yield_stress": "sigma_y yield_strength yield",
    "frequency frequencies": "f f0 freq freqs hz",
    "amplitude load": "force forcing excitation",
    "phase": "phi",
    "diameter": "d",
    "radius": "r",
    "gap cavity_length": "clearance",
    "contact": "restitution e cor coefficient_of_restitution law",
    "cavity_length length": "l height",
    "size": "dimensions lengths extent edges",
    "cavity": "container enclosure box",
    "displacement": "x0 initial_displacement",
    "velocity": "v0 initial_velocity",
    "duration": "t_end tend tmax t_max time end",
    "rate": "sampling_rate sample_rate fs",
    "dt": "step timestep time_step",
    "method": "solver integrator",
    "tolerance": "tol rtol atol",
    "shapes": "mode_shapes modes",
    "deviation": "std sigma standard_deviation",
    "smallest": "min minimum lower",
    "largest": "max maximum upper",
    "structure": "system oscillator",
    # kinds
    "harmonic": "sine sin sinusoid sinusoidal cosine cos",
    "half_sine": "pulse impulse shock halfsine",
    "record": "csv file time_series series table",
    "tsuji": "hertz hertz_mindlin hertzian mindlin",
    "linear": "hooke spring spring_dashpot kelvin_voigt lsd",
    "thornton": "elasto_plastic elastoplastic plastic walton_braun",
    "mindlin": "coulomb",
    "jackson_green": "jackson",
    "normal": "gaussian gauss",
    "log_normal": "lognormal",
    "box": "cuboid rectangular brick cube",
    "cylinder": "can pipe tube drum",
    "granular": "particle particles dem",
    "impact": "ball single",
    "sdof": "1dof single_degree_of_freedom spring_mass mass_spring",
    "matrices": "fem mdof",
    "event_driven": "event events exact",
    "two_step": "fixed_step",
}

MEANT: dict[str, tuple[str, ...]] = {}
"""What other programs and books call a field or a kind, with our names for it."""

for _names, _others in _OTHERS.items():
    for _other in _others.split():
        MEANT[_other] = (*MEANT.get(_other, ()), *_names.split())
