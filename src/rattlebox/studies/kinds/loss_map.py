"""A damper on a shaker: what it takes up, and how heavy it seems, over amplitude and frequency."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.structures import Shaker
from rattlebox.studies.axes import read_axes
from rattlebox.studies.kinds.sweep import Sweep
from rattlebox.studies.store import keep_map
from rattlebox.studies.study import (
    CONFIG,
    Cycles,
    Samples,
    Study,
    Values,
    study_function,
)

if TYPE_CHECKING:
    import xarray

MEASURES = ("loss_factor", "effective_mass", "damping_mass", "reduced_loss", "loss_per_cycle", "impacts_per_cycle")
"""What a loss map holds of each amplitude and frequency."""


@dataclass(frozen=True, config=CONFIG)
class LossMap(Study):
    """Shake a damper at every amplitude and frequency, and find what it takes up and how heavy it seems.

    The force that drives the damper is its apparent mass m' - i m'' times the acceleration of the cavity, in the first
    harmonic. The structure that carries the damper feels m' as added mass and pi m'' V^2 as loss in each cycle, V being the
    amplitude of its velocity. A light ball hardly changes how a heavy structure moves, so one map serves for any of them.

    Parameters
    ----------
    case
        On a Shaker with one Harmonic motion, which is replaced.
    amplitudes
        Of the motion, a list or `rb.geomspace`: displacements [m], or accelerations [m/s^2] where the case's motion is one.
    frequencies
        Of the motion [Hz].
    cycles
        How many to skip, until the motion is steady, and to average over.
    samples
        Equally spaced in those averaged over, from which the masses are found; default 64 a cycle. The loss needs none.
    workers, backend, store, progress
        Where the study runs, and where its results are stored; see `rattlebox.studies.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over amplitude and frequency: loss_factor (m'' over the size of m'), effective_mass m' [kg], damping_mass m'' [kg],
        reduced_loss (loss a cycle over m V^2), loss_per_cycle [J], impacts_per_cycle (but not in space), status; and
        particle_mass m [kg].

    Raises
    ------
    CaseError
        When the case has no shaker or another motion, or an argument does not fit.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="20 Hz")),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(diameter="10 mm", material="steel"), gap="2 mm", contact=rb.Tsuji(restitution=0.5)
    ...     ),
    ...     duration="1 s",
    ...     method=rb.Newton(),
    ... )
    >>> found = rb.loss_map(case, rb.geomspace("1 mm", "10 mm", 4), ["20 Hz", "40 Hz"])
    >>> found.loss_factor.dims
    ('structure.motion.amplitude', 'structure.motion.frequency')
    """

    kind: ClassVar[str] = "loss_map"

    amplitudes: Annotated[Values, Field(examples=[["1 mm", "2 mm"]])]
    frequencies: Annotated[Values, Field(examples=[{"from": "9 Hz", "to": "11 Hz", "count": 50}])]
    _: KW_ONLY
    cycles: Cycles = (50, 50)
    samples: Samples | None = None

    @cached_property
    def _sweep(self) -> Sweep:
        """Sweep over amplitudes and frequencies."""
        measures = [name for name in MEASURES if name != "impacts_per_cycle" or not self.case.particle_dampers]
        return Sweep(
            self.case,
            dict(self._axes.values()),
            measures,
            cycles=self.cycles,
            samples=self.samples,
        )

    @cached_property
    def _axes(self) -> dict[str, tuple[str, Any]]:
        """Paths and values by the name of the field."""
        given = {"amplitudes": self.amplitudes, "frequencies": self.frequencies}
        return {
            name: (f"structure.motion.{part}", list(values) if isinstance(values, Iterator) else values)
            for (name, values), part in zip(given.items(), ("amplitude", "frequency"), strict=True)
        }

    def validate(self) -> None:
        """Raise if the fields do not fit the case or each other; see `Study.validate`."""
        motion = self.case.structure.motion if isinstance(self.case.structure, Shaker) else ()
        if len(motion) != 1 or not isinstance(motion[0], Harmonic):
            raise Hint("a loss map needs a case on a shaker with one harmonic motion", "a structure of kind shaker")
        if not self.case.dampers:
            raise Hint("a loss map needs a case with a damper", "a ball in a gap, or particles in a cavity")
        for source, (path, values) in self._axes.items():
            column = read_axes(self.case, {path: values}, source=source).columns[path]
            for number, value in enumerate(column):
                if not value > 0:
                    raise CaseError(f"{source}: {path}[{number}] = {value:g}\n  must be greater than zero")
        self._sweep.validate()

    def compute(self) -> xarray.Dataset:
        """Run the sweep; see `Study.compute`."""
        found = self._sweep.run(**self.where)
        mass = sum(ball.weight for damper in self.case.impact_dampers for ball in damper.balls)
        mass += sum(float(damper.contents.mass.sum()) for damper in self.case.particle_dampers)
        found = found.assign(particle_mass=((), mass, {"units": "kg", "long_name": "mass of the particles"}))
        return keep_map(found, self.kind, self.store)


loss_map = study_function(LossMap)
"""Run a study of this kind: see `LossMap`."""
