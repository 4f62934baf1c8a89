"""Schema of a run: every output variable with its group, dimensions, unit and meaning.

The arrays are checked against these tables, and datasets, netCDF, MATLAB and CSV files are derived from them. Runs of the
impact engine are 1-D: their arrays have neither the dimension `axis` nor `partner`, which `variables` removes from their
variables. In datasets and netCDF files both have one entry, so that variables have the same dimensions in all runs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Literal

Kind = Literal["float", "int", "bool"]
Engine = Literal["impact", "dem"]

BOTH: tuple[Engine, ...] = ("impact", "dem")
_IMPACT: tuple[Engine, ...] = ("impact",)
_DEM: tuple[Engine, ...] = ("dem",)

AXES: tuple[str, ...] = ("x", "y", "z")
PARTNERS: tuple[str, ...] = ("particle", "wall")
"""Contact partners of a particle."""


LINE = "line"
"""Name of the axis of a 1-D run whose case states no direction of the base motion."""
ANY = "any"
"""Partner of the balls of a 1-D run, whose losses are not divided between walls and balls."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """One dimension of the variables."""

    name: str
    long_name: str
    units: str = ""
    engines: tuple[Engine, ...] = BOTH


@dataclass(frozen=True, slots=True)
class Group:
    """One dataset of a run."""

    name: str
    title: str
    along: str = "time"
    engines: tuple[Engine, ...] = BOTH
    absent: str = ""


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of a run."""

    name: str
    group: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    kind: Kind = "float"
    engines: tuple[Engine, ...] = BOTH
    derived: bool = False
    cumulative: bool = False
    coordinate: bool = False


DIMENSIONS: tuple[Dimension, ...] = (
    Dimension("time", "time", "s"),
    Dimension("point", "point of the structure"),
    Dimension("ball", "ball", engines=_IMPACT),
    Dimension("damper", "damper, or stop"),
    Dimension("stop", "stop", engines=_IMPACT),
    Dimension("source", "load"),
    Dimension("mode", "number of the mode", "1"),
    Dimension("axis", "axis", engines=_DEM),
    Dimension("partner", "contact partner of the particles", engines=_DEM),
    Dimension("wall", "wall of a cavity", engines=_DEM),
    Dimension("impact", "number of the impact, from 0", "1", engines=_IMPACT),
    Dimension("particle", "number of the particle, from 0, over all dampers", "1", engines=_DEM),
    Dimension("channel", "channel of the energy"),
)

GROUPS: tuple[Group, ...] = (
    Group("motion", "Motion of structure, cavities and particles in the frame of the base"),
    Group("energy", "Energy ledger in the frame of the base"),
    Group(
        "impacts",
        "Impact log, one entry for each closed contact",
        along="impact",
        engines=_IMPACT,
        absent="a 3-D run counts its contacts (motion.contacts, counts) and does not log them one by one",
    ),
    Group(
        "particles",
        "Particles at the end of the run, in their moving cavities",
        along="particle",
        engines=_DEM,
        absent="a 1-D run has balls, whose positions and velocities at all times are in motion",
    ),
)

_TIME = ("time",)
_POINT = ("time", "point")
_MODE = ("time", "mode")
_BALL = ("time", "ball")
_BASE = ("time", "axis")
_DAMPER = ("time", "damper")
_CAVITY = ("time", "damper", "axis")
_STOP = ("time", "stop")
_PARTNER = ("time", "damper", "partner")
_WALL = ("time", "wall")
_WALL_AXIS = ("time", "wall", "axis")
_LOG = ("impact",)
_EACH = ("particle",)
_EACH_AXIS = ("particle", "axis")

_1d = partial(Variable, engines=_IMPACT)
_3d = partial(Variable, engines=_DEM)

VARIABLES: tuple[Variable, ...] = (
    Variable("displacement", "motion", _POINT, "m", "displacement of the structure"),
    Variable("velocity", "motion", _POINT, "m/s", "velocity of the structure"),
    Variable("acceleration", "motion", _POINT, "m/s^2", "acceleration of the structure relative to the base"),
    Variable("absolute_acceleration", "motion", _POINT, "m/s^2", "absolute acceleration of the structure"),
    Variable("modal_displacement", "motion", _MODE, "kg^0.5 m", "modal displacement"),
    Variable("modal_velocity", "motion", _MODE, "kg^0.5 m/s", "modal velocity"),
    Variable("interface_force", "motion", _BASE, "N", "force of the structure on the base"),
    _1d("ball_position", "motion", _BALL, "m", "ball position from the cavity's rest place"),
    _1d("ball_velocity", "motion", _BALL, "m/s", "ball velocity"),
    _1d("relative_position", "motion", _BALL, "m", "ball position in the cavity"),
    _1d("relative_velocity", "motion", _BALL, "m/s", "ball velocity relative to the cavity"),
    _3d("cavity_displacement", "motion", _CAVITY, "m", "displacement of the cavity"),
    _3d("cavity_velocity", "motion", _CAVITY, "m/s", "velocity of the cavity"),
    Variable("cavity_force", "motion", _CAVITY, "N", "contact force on the cavity, or on the point at a stop"),
    _3d("turning_force", "motion", _CAVITY, "N", "contact force on the cavity along its turning axes"),
    _1d("stop_gap", "motion", _STOP, "m", "gap of the stop, negative while it is closed"),
    _1d("stop_impulse", "motion", _STOP, "N s", "impulse of the stop on the point since the start"),
    _3d("cavity_moment", "motion", _CAVITY, "N m", "contact moment about the cavity's centre"),
    _3d("centre_of_mass", "motion", _CAVITY, "m", "centre of mass of the particles in the cavity"),
    _3d("momentum", "motion", _CAVITY, "kg m/s", "momentum of the particles"),
    _3d("contacts", "motion", _PARTNER, "1", "number of contacts", "int"),
    _3d("coordination", "motion", _DAMPER, "1", "mean contacts of a particle", derived=True),
    _3d("wall_force", "motion", _WALL_AXIS, "N", "contact force on the wall"),
    _3d("wall_moment", "motion", _WALL_AXIS, "N m", "contact moment on the wall about the cavity's centre"),
    _3d("wall_normal_force", "motion", _WALL, "N", "sum of the normal contact forces on the wall"),
    _3d("wall_pressure", "motion", _WALL, "Pa", "normal contact force on the wall over its area", derived=True),
    _3d("wall_impulse", "motion", _WALL_AXIS, "N s", "impulse on the wall since the start", cumulative=True),
    _3d("wall_normal_impulse", "motion", _WALL, "N s", "sum of the normal impulses on the wall", cumulative=True),
    _3d("wall_impacts", "motion", _WALL, "1", "impacts on the wall since the start", "int", cumulative=True),
    _3d("cavity_angle", "motion", _DAMPER, "rad", "angle of the turning cavity"),
    _3d("cavity_speed", "motion", _DAMPER, "rad/s", "angular velocity of the turning cavity"),
    _3d("drive_torque", "motion", _DAMPER, "N m", "torque of the drive on the particles, about its axis"),
    Variable("base_displacement", "motion", _BASE, "m", "displacement of the base"),
    Variable("base_velocity", "motion", _BASE, "m/s", "velocity of the base"),
    Variable("base_acceleration", "motion", _BASE, "m/s^2", "acceleration of the base"),
    Variable("load", "motion", ("time", "source"), "N", "load on the structure"),
    _1d("ball_damper", "motion", ("ball",), "1", "damper that holds the ball, from 0", "int", coordinate=True),
    _1d("ball_centre", "motion", ("ball",), "m", "ball place in the packed, centred row"),
    _1d("clearance", "motion", ("damper",), "m", "total clearance of the cavity"),
    _3d("particle_mass", "motion", ("damper",), "kg", "mass of all particles"),
    _3d("wall_damper", "motion", ("wall",), "1", "damper of the wall, from 0", "int", coordinate=True),
    _3d("wall_area", "motion", ("wall",), "m^2", "area of the wall"),
    Variable("mode_frequency", "energy", ("mode",), "Hz", "natural frequency of the mode", coordinate=True),
    Variable("mode_energy", "energy", _MODE, "J", "energy of the mode"),
    _1d("ball_energy", "energy", _BALL, "J", "kinetic energy of the ball"),
    _3d("kinetic_energy", "energy", _DAMPER, "J", "translational energy of the particles"),
    _3d("rotation_energy", "energy", _DAMPER, "J", "rotational energy of the particles"),
    Variable("contact_energy", "energy", _DAMPER, "J", "elastic energy of the contacts"),
    Variable("gravity_energy", "energy", _DAMPER, "J", "gravity potential of the particles"),
    Variable("load_work", "energy", _TIME, "J", "work of the load", cumulative=True),
    Variable("base_work", "energy", _TIME, "J", "work of the inertial forces of the base motion", cumulative=True),
    _3d("drive_work", "energy", _DAMPER, "J", "work of the drive that turns the cavity", cumulative=True),
    Variable("viscous_loss", "energy", _TIME, "J", "loss in the structure's damping", cumulative=True),
    Variable("normal_loss", "energy", _PARTNER, "J", "loss in contacts by normal damping", cumulative=True),
    Variable("plastic_loss", "energy", _PARTNER, "J", "loss in contacts by plastic flow", cumulative=True),
    _3d(
        "sliding_loss", "energy", _PARTNER, "J", "loss in contacts by friction and tangential damping", cumulative=True
    ),
    _3d("rolling_loss", "energy", _PARTNER, "J", "loss in contacts by rolling resistance", cumulative=True),
    _3d("wall_normal_loss", "energy", _WALL, "J", "loss at the wall by normal damping", cumulative=True),
    _3d("wall_plastic_loss", "energy", _WALL, "J", "loss at the wall by plastic flow", cumulative=True),
    _3d("wall_sliding_loss", "energy", _WALL, "J", "loss at the wall by friction", cumulative=True),
    _3d("wall_rolling_loss", "energy", _WALL, "J", "loss at the wall by rolling resistance", cumulative=True),
    Variable("structure", "energy", _TIME, "J", "energy of the structure", derived=True),
    Variable("particles", "energy", _TIME, "J", "kinetic energy of the particles", derived=True),
    Variable("total", "energy", _TIME, "J", "total energy", derived=True),
    Variable("work", "energy", _TIME, "J", "work of load, base motion and drives", derived=True),
    Variable("losses", "energy", _TIME, "J", "energy lost since the start", derived=True),
    Variable("residual", "energy", _TIME, "J", "imbalance of the energy ledger", derived=True),
    Variable("share", "energy", ("channel",), "1", "share of the supplied energy at the end", derived=True),
    Variable(
        "damper_share", "energy", ("damper",), "1", "share of the supplied energy lost in this damper", derived=True
    ),
    _3d(
        "partner_share",
        "energy",
        ("partner",),
        "1",
        "share of the supplied energy lost with this partner",
        derived=True,
    ),
    _1d("damper", "impacts", _LOG, "1", "damper of the contact, from 0", "int"),
    _1d("contact", "impacts", _LOG, "1", "contact in the row: 0 trailing wall, n leading wall", "int"),
    _1d("time", "impacts", _LOG, "s", "time of first touch", coordinate=True),
    _1d("approach_speed", "impacts", _LOG, "m/s", "approach speed at first touch"),
    _1d("restitution", "impacts", _LOG, "1", "coefficient of restitution used"),
    _1d("separation_speed", "impacts", _LOG, "m/s", "separation speed at the end of the contact"),
    _1d("duration", "impacts", _LOG, "s", "duration of the contact"),
    _1d("peak_overlap", "impacts", _LOG, "m", "largest overlap"),
    _1d("peak_force", "impacts", _LOG, "N", "largest contact force"),
    _1d("energy_lost", "impacts", _LOG, "J", "energy lost in the contact"),
    _1d("complete", "impacts", _LOG, "1", "contact opened before the run ended", "bool"),
    _3d("position", "particles", _EACH_AXIS, "m", "position from the cavity's centre"),
    _3d("velocity", "particles", _EACH_AXIS, "m/s", "velocity relative to the base, or to the turning cavity"),
    _3d("spin", "particles", _EACH_AXIS, "rad/s", "angular velocity, relative to the turning cavity"),
    _3d("radius", "particles", _EACH, "m", "radius"),
    _3d("mass", "particles", _EACH, "kg", "mass"),
    _3d("damper", "particles", _EACH, "1", "damper that holds the particle, from 0", "int"),
    _3d("species", "particles", _EACH, "1", "species of the particle, from 0", "int"),
)


@cache
def dimensions(engine: Engine) -> dict[str, Dimension]:
    """Return the dimensions of the runs of an engine, by name."""
    return {dim.name: dim for dim in DIMENSIONS if engine in dim.engines}


@cache
def groups(engine: Engine) -> dict[str, Group]:
    """Return the groups of the runs of an engine, by name, in the order of files."""
    return {group.name: group for group in GROUPS if engine in group.engines}


@cache
def variables(engine: Engine, group: str | None = None) -> tuple[Variable, ...]:
    """Return the variables that an engine writes, without the dimensions that its runs lack."""
    known = dimensions(engine)
    return tuple(
        replace(v, dims=tuple(dim for dim in v.dims if dim in known))
        for v in VARIABLES
        if engine in v.engines and group in (None, v.group)
    )


@cache
def full_dims(group: str) -> dict[str, tuple[str, ...]]:
    """Return the dimensions of the variables of a group as datasets have them, the same for both engines."""
    return {v.name: v.dims for v in VARIABLES if v.group == group}


@cache
def channels(engine: Engine) -> tuple[str, ...]:
    """Return the channels of the supplied energy: the losses and "motion", whose shares at the end add up to one."""
    losses = (v.name for v in variables(engine) if v.cumulative and v.name.endswith("_loss") and "wall" not in v.dims)
    return (*(name.removesuffix("_loss") for name in losses), "motion")


def explain_absence(name: str, engine: Engine) -> str:
    """Return why runs of an engine have no group or variable of a name, and which groups they have."""
    runs = {"impact": "1-D run (impact engine)", "dem": "3-D run (dem engine)"}[engine]
    there = f"it has {', '.join(groups(engine))}"
    for group in GROUPS:
        if group.name == name:
            return f"this {runs} has no {name!r}: {group.absent}; {there}"
    same_name = [variable for variable in VARIABLES if variable.name == name]
    for variable in same_name:
        if engine in variable.engines and "wall" in variable.dims:
            return f"this run has no {name!r}: its walls were not recorded; output = rb.Output(walls=True) records them"
        if engine in variable.engines:
            return f"{name!r} is not one of the arrays along time; it is in run.{variable.group}"
    for variable in same_name:
        others = " and ".join(variable.engines)
        return f"this {runs} has no {name!r}, which only the {others} engine writes; {there}"
    return f"this {runs} has no {name!r}; {there}"


OUTCOMES = ("status", "warnings")
"""Variables of studies other than measures."""

COUNTS: dict[str, str] = {
    "events": "beginnings, ends and other switching points of contacts",
    "flights": "flights of balls between contacts",
    "contact_steps": "integration steps in contacts",
    "rejected_steps": "integration steps that were repeated with a shorter step",
    "collocated": "contacts solved by collocation",
    "extrapolated": "impacts outside of the measured speeds of a law",
    "sticks": "balls that came to rest at a wall or a ball",
    "simultaneous_impacts": "instants at which several hard impacts were resolved together",
    "impacts": "impacts, including those that are not logged",
    "steps": "time steps",
    "rebuilds": "rebuilds of neighbour lists",
    "refreshes": "searches of neighbour lists for pairs that may touch soon",
    "first_touches_particle": "first touches among particles",
    "first_touches_wall": "first touches of walls",
    "memory_bytes": "memory of particles, neighbours and contacts",
}
"""Meanings of the numbers in `counts`; memory is in bytes."""

DIAGNOSTICS: dict[str, tuple[str, str]] = {
    "step": ("s", "time step"),
    "longest_automatic_step": ("s", "time step that the automatic choice would take"),
    "expected_approach_speed": ("m/s", "approach speed for which the step is chosen"),
    "largest_approach_speed": ("m/s", "largest approach speed at a first touch"),
    "steps_per_contact": ("1", "steps in the shortest contact"),
    "largest_overlap": ("1", "largest overlap over the smaller radius"),
    "softening": ("1", "largest softening of a damper"),
    "bed_resonance": ("Hz", "estimated resonance of the softest bed under its own weight"),
    "softening_change": ("1", "estimated change of the loss in a cycle by softening, over m V^2"),
    "enduring_share": (
        "1",
        "share of the loss in contacts older than a quarter of a period, without that of balls that roll",
    ),
    "softened_enduring_share": ("1", "share of the loss in enduring contacts, of dampers with a softening above 1"),
    "fill_ratio": ("1", "volume of the particles over that of the cavities"),
    "bed_fill": ("1", "volume of the beds at the start over that of the cavities"),
}
"""Units and meanings of the numbers in `diagnostics`."""
