"""Synonyms of names in other programs and books, for suggestions, and names of what does not exist."""

_OTHERS = {  # ours: others'
    # faces of a box, for gravity along -z
    "-z": "bottom floor base_plate",
    "+z": "top roof lid ceiling",
    # fields
    "stiffness K": "k",
    "damping C": "c",
    "mass M": "m",
    "damping_ratio damping_ratios": "zeta xi modal_damping damping_factor",
    "damping": "damping_ratio",
    "columns": "channel channels column variable variables signal",
    "e restitution": "e cor coefficient_of_restitution",
    "friction coefficient": "mu friction_coefficient coefficient_of_friction sliding_friction",
    "rolling coefficient": "mu_r rolling_friction rolling_resistance",
    "count": "n number amount num quantity",
    "fill_ratio": "fill filling packing_fraction volume_fraction",
    "bed_fill": "fill_level fill_height bed_volume bed_ratio",
    "particles.bed_fill": "bed_fill fill_level",
    "particles.fill_ratio": "fill_ratio fill filling packing_fraction volume_fraction",
    "particles.count": "count n number",
    "particles.diameter": "diameter",
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
    "geometric_standard_deviation": "spread gsd sigma_g",
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
    "power": "hunt_crossley kuwabara_kono lankarani_nikravesh power_law viscoelastic",
    "tabulated": "measured force_deflection hysteretic",
    "thornton": "elasto_plastic elastoplastic plastic walton_braun",
    "mindlin": "coulomb",
    "jackson_green": "jackson",
    "normal": "gaussian gauss",
    "log_normal": "lognormal",
    "box": "cuboid rectangular brick cube",
    "cylinder": "can pipe tube drum",
    "particle": "granular particles dem",
    "impact": "ball single",
    "sdof": "1dof single_degree_of_freedom spring_mass mass_spring",
    "matrices": "fem mdof",
    "compacted": "dense tapped shaken",
    "settled": "poured loose",
    "event_driven": "event events exact",
    "two_step": "fixed_step",
}

MEANT: dict[str, tuple[str, ...]] = {}
"""Names of fields and kinds by their names in other programs and books."""

for _names, _others in _OTHERS.items():
    for _other in _others.split():
        MEANT[_other] = (*MEANT.get(_other, ()), *_names.split())

_ABSENT = {  # what does not exist, and what to do instead: others' names
    ("contacts are dry, without cohesion, adhesion or liquid", "restitution, friction and rolling"): (
        "cohesion cohesive adhesion adhesive jkr dmt surface_energy work_of_adhesion liquid liquid_bridge capillary "
        "moisture humidity wet van_der_waals hamaker surface_tension cohesion_energy_density bond bonds"
    ),
    ("all particles are round spheres", "rolling = 0.1, a resistance in place of corners"): (
        "shape shapes aspect_ratio sphericity roundness angularity blockiness cube cubes polyhedron polyhedra ellipsoid "
        "superquadric clump clumps multisphere half_axes fibre fiber"
    ),
    ("no air or liquid is between balls, particles and walls", "remove it, and compare a lower restitution"): (
        "drag drag_coefficient fluid air viscosity fluid_density buoyancy gas lubrication"
    ),
    (
        "only a box has parallel faces through which particles can pass",
        'cavity = { kind = "box", periodic = "x", ... }',
    ): ("periodic periodicity periodic_boundary periodic_boundaries periodic_bc pbc periodic_axes"),
    (
        "the damper turns, not a part of it",
        'rotation = { speed = "700 rpm", arm = ["0.2 m", 0, 0] } of the particle damper',
    ): (
        "rotation rotating rotation_speed rotational_speed rotation_rate rotation_axis rotation_frequency angular_velocity "
        "angular_speed rpm omega tilt spin_rate axis_of_rotation centrifugal"
    ),
}

ABSENT: dict[str, tuple[str, str]] = {name: statement for statement, names in _ABSENT.items() for name in names.split()}
"""What does not exist, and what to do instead, by names of fields and kinds that others use for it."""
