"""What a run holds: every variable with its group, dimensions, unit and meaning, told once.

The arrays are checked against this table, and the datasets and all files are written from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Kind = Literal["float", "int", "bool"]

GROUPS: tuple[str, ...] = ("motion", "energy", "impacts")
GROUP_TITLES: dict[str, str] = {
    "motion": "Motion of the structure and the balls in the frame of the base",
    "energy": "Energy ledger in the frame of the base",
    "impacts": "Impact log, one entry for each closed contact",
}


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of a run.

    Attributes
    ----------
    name
        Name of the field in the arrays, of the variable in datasets and files.
    group
        Dataset that holds it.
    dims
        Names of the dimensions, in order.
    units
        SI unit, "1" for pure numbers.
    long_name
        Meaning in a few words, fit for an axis label.
    kind
        Number type.
    """

    name: str
    group: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    kind: Kind = "float"


_TIME = ("time",)
_POINT = ("time", "point")
_BALL = ("time", "ball")
_DAMPER = ("time", "damper")
_IMPACT = ("impact",)

RUN_VARIABLES: tuple[Variable, ...] = (
    Variable("displacement", "motion", _POINT, "m", "displacement of the structure"),
    Variable("velocity", "motion", _POINT, "m/s", "velocity of the structure"),
    Variable("ball_position", "motion", _BALL, "m", "ball position from the cavity's rest place"),
    Variable("ball_velocity", "motion", _BALL, "m/s", "ball velocity"),
    Variable("relative_position", "motion", _BALL, "m", "ball position in the cavity"),
    Variable("relative_velocity", "motion", _BALL, "m/s", "ball velocity relative to the cavity"),
    Variable("base_displacement", "motion", _TIME, "m", "displacement of the base"),
    Variable("base_velocity", "motion", _TIME, "m/s", "velocity of the base"),
    Variable("base_acceleration", "motion", _TIME, "m/s^2", "acceleration of the base"),
    Variable("cavity_force", "motion", _DAMPER, "N", "force of the balls on the cavity"),
    Variable("load", "motion", ("time", "source"), "N", "load on the structure"),
    Variable("ball_damper", "motion", ("ball",), "1", "damper that holds the ball, from 0", "int"),
    Variable("ball_centre", "motion", ("ball",), "m", "ball place in the packed, centred row"),
    Variable("clearance", "motion", ("damper",), "m", "total clearance of the cavity"),
    Variable("mode_frequency", "energy", ("mode",), "Hz", "natural frequency of the mode"),
    Variable("mode_energy", "energy", ("time", "mode"), "J", "energy of the mode"),
    Variable("ball_energy", "energy", _BALL, "J", "kinetic energy of the ball"),
    Variable("contact_energy", "energy", _DAMPER, "J", "elastic energy of the contacts"),
    Variable("gravity_energy", "energy", _DAMPER, "J", "gravity potential of the balls"),
    Variable("load_work", "energy", _TIME, "J", "work of the load"),
    Variable("base_work", "energy", _TIME, "J", "work of the inertial forces of the base motion"),
    Variable("viscous_loss", "energy", _TIME, "J", "loss in the structure's damping"),
    Variable("normal_loss", "energy", _DAMPER, "J", "loss in impacts by damping"),
    Variable("plastic_loss", "energy", _DAMPER, "J", "loss in impacts by plastic flow"),
)

IMPACT_VARIABLES: tuple[Variable, ...] = (
    Variable("damper", "impacts", _IMPACT, "1", "damper of the contact, from 0", "int"),
    Variable("contact", "impacts", _IMPACT, "1", "contact in the row: 0 trailing wall, n leading wall", "int"),
    Variable("time", "impacts", _IMPACT, "s", "time of first touch"),
    Variable("approach_speed", "impacts", _IMPACT, "m/s", "approach speed at first touch"),
    Variable("restitution", "impacts", _IMPACT, "1", "coefficient of restitution used"),
    Variable("separation_speed", "impacts", _IMPACT, "m/s", "separation speed at the end of the contact"),
    Variable("duration", "impacts", _IMPACT, "s", "duration of the contact"),
    Variable("peak_overlap", "impacts", _IMPACT, "m", "largest overlap"),
    Variable("peak_force", "impacts", _IMPACT, "N", "largest contact force"),
    Variable("energy_lost", "impacts", _IMPACT, "J", "energy lost in the contact"),
    Variable("complete", "impacts", _IMPACT, "1", "contact opened before the run ended", "bool"),
)

DERIVED_VARIABLES: tuple[Variable, ...] = (
    Variable("structure", "energy", _TIME, "J", "energy of the structure"),
    Variable("particles", "energy", _TIME, "J", "kinetic energy of the balls"),
    Variable("total", "energy", _TIME, "J", "total energy"),
    Variable("work", "energy", _TIME, "J", "work of load and base motion"),
    Variable("losses", "energy", _TIME, "J", "energy lost since the start"),
    Variable("residual", "energy", _TIME, "J", "what the ledger misses"),
    Variable("share", "energy", ("channel",), "1", "share of the supplied energy at the end"),
    Variable("damper_share", "energy", ("damper",), "1", "share of the supplied energy lost in this damper"),
)

CHANNELS: tuple[str, ...] = ("viscous", "impact", "plastic", "motion")
"""Where the supplied energy can be found at the end of a run; the shares add up to one."""

COORDINATES: dict[str, tuple[str, str]] = {
    "time": ("s", "time"),
    "point": ("", "point of the structure"),
    "ball": ("", "ball"),
    "damper": ("", "damper"),
    "source": ("", "load"),
    "mode": ("1", "number of the mode"),
    "channel": ("", "channel of the energy"),
}
"""Unit and meaning of each coordinate; names have no unit."""


@dataclass(frozen=True)
class Form:
    """What a kind of run holds.

    Attributes
    ----------
    name
        Kind of run.
    titles
        Title of each group, in the order of files.
    stored, derived
        Variables that the arrays hold, and those that follow from them.
    coordinates
        Unit and meaning of each coordinate.
    labels
        Name of the attribute of the arrays that holds the labels of each dimension.
    """

    name: str
    titles: Mapping[str, str]
    stored: tuple[Variable, ...]
    derived: tuple[Variable, ...]
    coordinates: Mapping[str, tuple[str, str]]
    labels: Mapping[str, str]

    def variables(self, group: str) -> tuple[Variable, ...]:
        """Stored and derived variables of a dataset, in the order of files."""
        return tuple(v for v in self.stored + self.derived if v.group == group)


IMPACT = Form(
    name="impact",
    titles=GROUP_TITLES,
    stored=RUN_VARIABLES + IMPACT_VARIABLES,
    derived=DERIVED_VARIABLES,
    coordinates=COORDINATES,
    labels={
        "time": "time",
        "point": "points",
        "ball": "balls",
        "damper": "dampers",
        "source": "loads",
        "mode": "modes",
        "channel": "channels",
    },
)
"""Runs of impact dampers, and of structures without dampers."""

_SPACE = ("time", "axis")
_CAVITY = ("time", "damper", "axis")
_PARTNER = ("time", "damper", "partner")
_EACH = ("particle",)
_EACH_SPACE = ("particle", "axis")

GRANULAR_CHANNELS: tuple[str, ...] = ("viscous", "normal", "plastic", "sliding", "rolling", "motion")
"""Where the supplied energy can be found at the end of a run with particles; the shares add up to one."""

PARTNERS: tuple[str, ...] = ("particle", "wall")
"""What a particle may touch."""

GRANULAR = Form(
    name="granular",
    titles={
        "motion": "Motion of the structure, the cavities and the particles as a whole, in the frame of the base",
        "energy": "Energy ledger in the frame of the base",
        "particles": "Particles at the end of the run, in their moving cavities",
    },
    stored=(
        Variable("displacement", "motion", _POINT, "m", "displacement of the structure"),
        Variable("velocity", "motion", _POINT, "m/s", "velocity of the structure"),
        Variable("cavity_displacement", "motion", _CAVITY, "m", "displacement of the cavity"),
        Variable("cavity_velocity", "motion", _CAVITY, "m/s", "velocity of the cavity"),
        Variable("cavity_force", "motion", _CAVITY, "N", "force of the particles on the cavity"),
        Variable("cavity_moment", "motion", _CAVITY, "N m", "moment of the particles about the cavity's centre"),
        Variable("centre_of_mass", "motion", _CAVITY, "m", "centre of mass of the particles in the cavity"),
        Variable("momentum", "motion", _CAVITY, "kg m/s", "momentum of the particles"),
        Variable("contacts", "motion", _PARTNER, "1", "contacts", "int"),
        Variable("base_displacement", "motion", _SPACE, "m", "displacement of the base"),
        Variable("base_velocity", "motion", _SPACE, "m/s", "velocity of the base"),
        Variable("base_acceleration", "motion", _SPACE, "m/s^2", "acceleration of the base"),
        Variable("load", "motion", ("time", "source"), "N", "load on the structure"),
        Variable("particle_mass", "motion", ("damper",), "kg", "mass of all particles"),
        Variable("mode_frequency", "energy", ("mode",), "Hz", "natural frequency of the mode"),
        Variable("mode_energy", "energy", ("time", "mode"), "J", "energy of the mode"),
        Variable("kinetic_energy", "energy", _DAMPER, "J", "kinetic energy of the particles' translation"),
        Variable("rotation_energy", "energy", _DAMPER, "J", "kinetic energy of the particles' spin"),
        Variable("contact_energy", "energy", _DAMPER, "J", "elastic energy of the contacts"),
        Variable("gravity_energy", "energy", _DAMPER, "J", "gravity potential of the particles"),
        Variable("load_work", "energy", _TIME, "J", "work of the load"),
        Variable("base_work", "energy", _TIME, "J", "work of the inertial forces of the base motion"),
        Variable("viscous_loss", "energy", _TIME, "J", "loss in the structure's damping"),
        Variable("normal_loss", "energy", _PARTNER, "J", "loss in contacts by damping along the normal"),
        Variable("plastic_loss", "energy", _PARTNER, "J", "loss in contacts by plastic flow"),
        Variable("sliding_loss", "energy", _PARTNER, "J", "loss in contacts by friction and tangential damping"),
        Variable("rolling_loss", "energy", _PARTNER, "J", "loss in contacts by rolling resistance"),
        Variable("position", "particles", _EACH_SPACE, "m", "place in the cavity"),
        Variable("particle_velocity", "particles", _EACH_SPACE, "m/s", "velocity relative to the base"),
        Variable("spin", "particles", _EACH_SPACE, "rad/s", "spin"),
        Variable("radius", "particles", _EACH, "m", "radius"),
        Variable("mass", "particles", _EACH, "kg", "mass"),
        Variable("particle_damper", "particles", _EACH, "1", "damper that holds the particle, from 0", "int"),
        Variable("particle_species", "particles", _EACH, "1", "species of the particle, from 0", "int"),
    ),
    derived=(
        Variable("coordination", "motion", _DAMPER, "1", "contacts of a particle in the mean"),
        Variable("structure", "energy", _TIME, "J", "energy of the structure"),
        Variable("particles", "energy", _TIME, "J", "kinetic energy of the particles"),
        Variable("total", "energy", _TIME, "J", "total energy"),
        Variable("work", "energy", _TIME, "J", "work of load and base motion"),
        Variable("losses", "energy", _TIME, "J", "energy lost since the start"),
        Variable("residual", "energy", _TIME, "J", "what the ledger misses"),
        Variable("share", "energy", ("channel",), "1", "share of the supplied energy at the end"),
        Variable("damper_share", "energy", ("damper",), "1", "share of the supplied energy lost in this damper"),
        Variable("partner_share", "energy", ("partner",), "1", "share of the supplied energy lost with this partner"),
    ),
    coordinates={
        "time": ("s", "time"),
        "point": ("", "point of the structure"),
        "damper": ("", "damper"),
        "source": ("", "load"),
        "mode": ("1", "number of the mode"),
        "axis": ("", "axis"),
        "partner": ("", "what the particles touch"),
        "particle": ("1", "number of the particle, from 0, over all dampers"),
        "channel": ("", "channel of the energy"),
    },
    labels={
        "time": "time",
        "point": "points",
        "damper": "dampers",
        "source": "loads",
        "mode": "modes",
        "axis": "axes",
        "partner": "partners",
        "particle": "numbers",
        "channel": "channels",
    },
)
"""Runs of particle dampers."""

HOW_ENDED = ("status", "warnings")
"""What studies hold of each run beside its measures."""

COUNTS: dict[str, str] = {
    "events": "touches, openings and other turns of a contact",
    "flights": "flights of balls between contacts",
    "contact_steps": "integration steps in contacts",
    "rejected_steps": "integration steps that were tried again, shorter",
    "collocated": "contacts solved as a whole",
    "extrapolated": "impacts outside of the measured speeds of a law",
    "sticks": "balls that came to rest at a wall or a ball",
    "impacts": "impacts, those that are not kept included",
    "steps": "time steps",
    "rebuilds": "neighbour lists made anew",
    "refreshes": "neighbour lists looked through for pairs that may touch soon",
    "first_touches_particle": "first touches among particles",
    "first_touches_wall": "first touches of walls",
    "memory_bytes": "memory of particles, neighbours and contacts",
}
"""What the numbers in `counts` count; memory is in bytes."""

FIGURES: dict[str, tuple[str, str]] = {
    "step": ("s", "time step"),
    "longest_automatic_step": ("s", "time step that would have been chosen"),
    "expected_approach_speed": ("m/s", "approach speed that the step allows for"),
    "largest_approach_speed": ("m/s", "largest approach speed at a first touch"),
    "steps_per_contact": ("1", "steps in the shortest contact"),
    "largest_overlap": ("1", "largest overlap over the smaller radius"),
    "softening": ("1", "largest softening of a damper"),
    "bed_resonance": ("Hz", "estimated resonance of the softest bed under its own weight"),
    "softening_change": ("1", "estimated change of the loss in a cycle by softening, over m V^2"),
    "enduring_share": ("1", "share of the loss in contacts older than a quarter of a period"),
    "softened_enduring_share": ("1", "the same, of dampers with a softening above 1"),
}
"""Units and meanings of the numbers in `figures`."""
