"""Report about a loss map."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from rattlebox._util.quantities import amount
from rattlebox.plots.loss_map import plot_loss_map
from rattlebox.report import study_words as words
from rattlebox.report.kinds.sweep import KIND as SWEEP
from rattlebox.report.kinds.sweep import options_of
from rattlebox.report.parts import Call, Kind, Limit, Picture
from rattlebox.results.case_words import dampers_words

if TYPE_CHECKING:
    import xarray as xr

_AMPLITUDE, _FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"


def _question(study: xr.Dataset) -> str:
    try:
        damper = dampers_words(words.cases_of(study)[""])
    except ValueError:  # CaseError
        damper = "the damper"
    ends = " and ".join(words.axis_words(study[name]).partition(" (")[2][:-1] for name in (_AMPLITUDE, _FREQUENCY))
    return f"How much energy does {damper} take from its cavity, and which mass does it add, over {ends}?"


def _answer(study: xr.Dataset) -> Iterator[str]:
    if unfinished := words.progress_sentence(study):
        yield unfinished
    yield f"The particles have a mass of {amount(float(study.particle_mass), 'kg')}."
    for name in ("loss_per_cycle", "reduced_loss", "effective_mass"):
        if name in study and (sentence := words.extremes(study, name)):
            yield sentence


def _pictures(study: xr.Dataset) -> Iterator[Picture]:
    yield Picture(
        "Loss factor, effective mass over the mass of the particles, and loss per cycle over m V², with the mass m of the "
        "particles and the velocity amplitude V of the cavity.",
        partial(plot_loss_map, study, size="page"),
    )


def _limits(study: xr.Dataset) -> Iterator[Limit]:
    yield Limit(
        "first harmonic",
        "",
        "",
        "The map holds for harmonic motion of the cavity. On a structure it applies where the damper changes the motion "
        "little, and nearly all of the motion is in the first harmonic; outside of its amplitudes and frequencies nothing "
        "is known.",
    )
    yield from words.study_limits(study)


def _call(study: xr.Dataset) -> Call:
    return Call(
        "loss_map",
        {
            "amplitudes": study[_AMPLITUDE].values.tolist(),
            "frequencies": study[_FREQUENCY].values.tolist(),
            **options_of(study, "cycles", "samples"),
        },
        "loss_map",
    )


KIND = Kind(
    name="Loss map",
    cases=words.cases_of,
    question=_question,
    answer=_answer,
    call=_call,
    pictures=_pictures,
    tables=SWEEP.tables,
    warnings=SWEEP.warnings,
    limits=_limits,
    about=SWEEP.about,
)
