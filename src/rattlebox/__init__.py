"""Simulator and design tool for particle and impact dampers.

The one import path: `import rattlebox as rb`. Everything public is a name of this module; heavy parts load when first
used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rattlebox.model.case import Case
from rattlebox.model.cavities import Box, Cylinder, SphericalCavity
from rattlebox.model.contacts import Linear, Thornton, Tsuji, alpha_of_restitution, restitution_of_alpha
from rattlebox.model.dampers import ImpactDamper, Sphere
from rattlebox.model.errors import CaseError
from rattlebox.model.friction import LinearSpring, Mindlin, Rolling
from rattlebox.model.granular import PairLaws, ParticleDamper
from rattlebox.model.materials import Material, materials
from rattlebox.model.methods import Dem, EventDriven, Newton, Output, TwoStep
from rattlebox.model.packing import Lattice, Positions, Settled
from rattlebox.model.pairs import Body, Pair, contact_pairs
from rattlebox.model.particles import LogNormal, Normal, Particles, Sieve
from rattlebox.model.restitutions import Constant, JacksonGreen, Johnson, Tabulated, ThorntonRestitution
from rattlebox.model.signals import HalfSine, Harmonic, Record, chirp, random_record
from rattlebox.model.structures import SDOF, Fixed, Matrices, Modal, Shaker

if TYPE_CHECKING:
    from rattlebox import analysis
    from rattlebox.engines.curves import restitution_curve
    from rattlebox.engines.simulate import simulate, simulate_many
    from rattlebox.plots.basins import plot_basins
    from rattlebox.plots.bifurcation import plot_bifurcation
    from rattlebox.plots.design import plot_design
    from rattlebox.plots.loss_map import plot_loss_map
    from rattlebox.plots.lyapunov import plot_lyapunov
    from rattlebox.plots.maps import plot_map
    from rattlebox.plots.particles import film_particles, plot_particles
    from rattlebox.plots.response import plot_frequency_response
    from rattlebox.plots.sensitivity import plot_sensitivity
    from rattlebox.results import Run, load
    from rattlebox.results.snapshots import Snapshots
    from rattlebox.studies.basins import basins
    from rattlebox.studies.bifurcation import bifurcation
    from rattlebox.studies.design import design
    from rattlebox.studies.designs import geomspace, linspace, random_design, replicas
    from rattlebox.studies.frequency_response import frequency_response
    from rattlebox.studies.loss_map import loss_map
    from rattlebox.studies.lyapunov import lyapunov
    from rattlebox.studies.measures import MEASURES
    from rattlebox.studies.sensitivity import sensitivity
    from rattlebox.studies.store import open_study
    from rattlebox.studies.sweep import sweep

__version__ = "0.1.0"

_LATER = {
    "simulate": "rattlebox.engines.simulate",
    "simulate_many": "rattlebox.engines.simulate",
    "sweep": "rattlebox.studies.sweep",
    "MEASURES": "rattlebox.studies.measures",
    "restitution_curve": "rattlebox.engines.curves",
    "Run": "rattlebox.results",
    "load": "rattlebox.results",
    "frequency_response": "rattlebox.studies.frequency_response",
    "basins": "rattlebox.studies.basins",
    "bifurcation": "rattlebox.studies.bifurcation",
    "plot_basins": "rattlebox.plots.basins",
    "plot_bifurcation": "rattlebox.plots.bifurcation",
    "film_particles": "rattlebox.plots.particles",
    "plot_particles": "rattlebox.plots.particles",
    "Snapshots": "rattlebox.results.snapshots",
    "plot_design": "rattlebox.plots.design",
    "plot_frequency_response": "rattlebox.plots.response",
    "plot_loss_map": "rattlebox.plots.loss_map",
    "plot_lyapunov": "rattlebox.plots.lyapunov",
    "plot_map": "rattlebox.plots.maps",
    "plot_sensitivity": "rattlebox.plots.sensitivity",
    "design": "rattlebox.studies.design",
    "loss_map": "rattlebox.studies.loss_map",
    "open_study": "rattlebox.studies.store",
    "sensitivity": "rattlebox.studies.sensitivity",
    "lyapunov": "rattlebox.studies.lyapunov",
    "geomspace": "rattlebox.studies.designs",
    "linspace": "rattlebox.studies.designs",
    "random_design": "rattlebox.studies.designs",
    "replicas": "rattlebox.studies.designs",
}

__all__ = [
    "MEASURES",
    "SDOF",
    "Body",
    "Box",
    "Case",
    "CaseError",
    "Constant",
    "Cylinder",
    "Dem",
    "EventDriven",
    "Fixed",
    "HalfSine",
    "Harmonic",
    "ImpactDamper",
    "JacksonGreen",
    "Johnson",
    "Lattice",
    "Linear",
    "LinearSpring",
    "LogNormal",
    "Material",
    "Matrices",
    "Mindlin",
    "Modal",
    "Newton",
    "Normal",
    "Output",
    "Pair",
    "PairLaws",
    "ParticleDamper",
    "Particles",
    "Positions",
    "Record",
    "Rolling",
    "Run",
    "Settled",
    "Shaker",
    "Sieve",
    "Snapshots",
    "Sphere",
    "SphericalCavity",
    "Tabulated",
    "Thornton",
    "ThorntonRestitution",
    "Tsuji",
    "TwoStep",
    "alpha_of_restitution",
    "analysis",
    "basins",
    "bifurcation",
    "chirp",
    "contact_pairs",
    "design",
    "film_particles",
    "frequency_response",
    "geomspace",
    "linspace",
    "load",
    "loss_map",
    "lyapunov",
    "materials",
    "open_study",
    "plot_basins",
    "plot_bifurcation",
    "plot_design",
    "plot_frequency_response",
    "plot_loss_map",
    "plot_lyapunov",
    "plot_map",
    "plot_particles",
    "plot_sensitivity",
    "random_design",
    "random_record",
    "replicas",
    "restitution_curve",
    "restitution_of_alpha",
    "sensitivity",
    "simulate",
    "simulate_many",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name == "analysis":
        return import_module("rattlebox.analysis")
    if name in _LATER:
        value = getattr(import_module(_LATER[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'rattlebox' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
