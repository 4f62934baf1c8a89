"""Simulator and design tool for particle and impact dampers.

The one import path: `import rattlebox as rb`. Everything public is a name of this module, and loads when it is first
used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rattlebox import analysis
    from rattlebox.engines.curves import restitution_curve
    from rattlebox.engines.simulate import simulate, simulate_many
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

_PLACES = {
    "rattlebox.engines.curves": "restitution_curve",
    "rattlebox.engines.simulate": "simulate simulate_many",
    "rattlebox.model.case": "Case",
    "rattlebox.model.cavities": "Box Cylinder SphericalCavity",
    "rattlebox.model.contacts": "Linear Thornton Tsuji alpha_of_restitution restitution_of_alpha",
    "rattlebox.model.dampers": "ImpactDamper Sphere",
    "rattlebox.model.errors": "CaseError",
    "rattlebox.model.friction": "LinearSpring Mindlin Rolling",
    "rattlebox.model.granular": "PairLaws ParticleDamper",
    "rattlebox.model.materials": "Material materials",
    "rattlebox.model.methods": "Dem EventDriven Newton Output TwoStep",
    "rattlebox.model.packing": "Lattice Positions Settled",
    "rattlebox.model.pairs": "Body Pair contact_pairs",
    "rattlebox.model.particles": "LogNormal Normal Particles Sieve",
    "rattlebox.model.restitutions": "Constant JacksonGreen Johnson Tabulated ThorntonRestitution",
    "rattlebox.model.signals": "HalfSine Harmonic Record chirp random_record",
    "rattlebox.model.structures": "Fixed Matrices Modal SDOF Shaker",
    "rattlebox.plots.basins": "plot_basins",
    "rattlebox.plots.bifurcation": "plot_bifurcation",
    "rattlebox.plots.design": "plot_design",
    "rattlebox.plots.loss_map": "plot_loss_map",
    "rattlebox.plots.lyapunov": "plot_lyapunov",
    "rattlebox.plots.maps": "plot_map",
    "rattlebox.plots.particles": "film_particles plot_particles",
    "rattlebox.plots.response": "plot_frequency_response",
    "rattlebox.plots.sensitivity": "plot_sensitivity",
    "rattlebox.results": "Run load",
    "rattlebox.results.snapshots": "Snapshots",
    "rattlebox.studies.basins": "basins",
    "rattlebox.studies.bifurcation": "bifurcation",
    "rattlebox.studies.design": "design",
    "rattlebox.studies.designs": "geomspace linspace random_design replicas",
    "rattlebox.studies.frequency_response": "frequency_response",
    "rattlebox.studies.loss_map": "loss_map",
    "rattlebox.studies.lyapunov": "lyapunov",
    "rattlebox.studies.measures": "MEASURES",
    "rattlebox.studies.sensitivity": "sensitivity",
    "rattlebox.studies.store": "open_study",
    "rattlebox.studies.sweep": "sweep",
}
_LATER = {name: module for module, names in _PLACES.items() for name in names.split()}

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
        import_module("rattlebox.model.case")  # before all else: messages list kinds in the order in which they load
        value = getattr(import_module(_LATER[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'rattlebox' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
