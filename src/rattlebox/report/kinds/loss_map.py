"""Report about a loss map."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rattlebox._util.quantities import amount
from rattlebox.plots.loss_map import plot_loss_map
from rattlebox.report import study_words as words
from rattlebox.report.arguments import options_of
from rattlebox.report.kinds.sweep import KIND as SWEEP
from rattlebox.report.limits import limit
from rattlebox.report.parts import Call, Limit

if TYPE_CHECKING:
    import xarray as xr

_AMPLITUDE, _FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"


def _question(study: xr.Dataset) -> str:
    ends = " and ".join(words.axis_words(study[name]).partition(" (")[2][:-1] for name in (_AMPLITUDE, _FREQUENCY))
    damper = words.damper_words(study)
    return f"How much energy does {damper} take from its cavity, and which mass does it add, over {ends}?"


def _answer(study: xr.Dataset) -> Iterator[str]:
    yield f"The particles have a mass of {amount(float(study.particle_mass), 'kg')}."
    for name in ("loss_per_cycle", "reduced_loss", "effective_mass"):
        if name in study and (sentence := words.extremes(study, name)):
            yield sentence


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    yield limit("loss_map", "first harmonic", "")
    yield from words.study_limits(study)


def _call(study: xr.Dataset) -> Call:
    axes = {"amplitudes": study[_AMPLITUDE].values.tolist(), "frequencies": study[_FREQUENCY].values.tolist()}
    return Call("loss_map", {**axes, **options_of(study, "cycles", "samples")}, "loss_map")


KIND = words.study_kind(
    "Loss map",
    _question,
    _answer,
    _call,
    words.picture(
        plot_loss_map,
        "Loss factor, effective mass over the mass of the particles, and loss per cycle over m V², with the mass m of the "
        "particles and the velocity amplitude V of the cavity.",
    ),
    tables=SWEEP.tables,
    limits=_limits,
)
