"""Loss maps: loss and effective mass of a damper on a shaker over amplitude and frequency."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from rattlebox._util.exceptions import CaseError
from rattlebox.model.errors import Hint
from rattlebox.studies.grid.axes import ParsedAxes, parse_axes, read_axes
from rattlebox.studies.kinds.sweep import result_notes
from rattlebox.studies.run.store import save_result
from rattlebox.studies.run.study import (
    CONFIG,
    Cycles,
    Samples,
    Study,
    Values,
    study_function,
)
from rattlebox.studies.work.impact import ImpactEngine
from rattlebox.studies.work.particles import EXTENSIONS, ParticleEngine
from rattlebox.studies.work.reductions import ForceHarmonics
from rattlebox.studies.work.variants import AMPLITUDE, FREQUENCY, Variants
from rattlebox.studies.work.work import Work

if TYPE_CHECKING:
    import xarray

MEASURES = ("loss_factor", "effective_mass", "damping_mass", "reduced_loss", "loss_per_cycle", "impacts_per_cycle")
"""Measures of a loss map."""

CYCLES = (50, 50)
"""Default numbers of cycles to skip and to average over."""


@dataclass(frozen=True, config=CONFIG)
class LossMap(Study):
    r"""Compute loss and effective mass of a damper on a shaker over amplitude and frequency.

    In the first harmonic, the force that drives the damper is its apparent mass m' - i m'' times the acceleration of the
    cavity. For the structure, m' is an added mass, and :math:`\pi m'' V^2` is the loss per cycle at the velocity amplitude
    V. `rb.response_from_map` computes the response of structures from a map. `to_netcdf` writes it to a file.

    Parameters
    ----------
    case
        Case on a `Shaker` with one `Harmonic` motion, whose amplitude and frequency are replaced.
    amplitudes
        Amplitudes of the motion, a list or `rb.geomspace`: displacements [m], or accelerations [m/s^2] if the motion of
        the case is an acceleration.
    frequencies
        Frequencies of the motion [Hz].
    cycles
        Numbers of cycles to skip until the motion is steady, and to average over. By default 50 and 50; runs of particles
        whose motion is not steady then continue by 50 cycles, up to four times.
    samples
        Number of equally spaced samples in the averaged cycles, for the masses; default 64 per cycle.
    workers, backend, store, progress
        Execution and storage; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    xarray.Dataset
        Over amplitude and frequency: `loss_factor` :math:`m''/|m'|`, `effective_mass` m' [kg], `damping_mass` m'' [kg],
        `reduced_loss` (loss per cycle over m V^2), `loss_per_cycle` [J], `impacts_per_cycle` (impact dampers only),
        `force_harmonics` [N] (over `harmonic`, too: amplitudes of the force on the particles), `force_variation` [N] (of
        the complex amplitude of the first harmonic from cycle to cycle, root mean square), `status`; `particle_mass` m [kg].
        For particle dampers also `warnings`, with the flag "unsteady" of motions that are not steady, `skipped_cycles` (with
        the default cycles), the `softening` of each run, and `softening_change`, its estimated effect on
        the reduced loss, NaN where it cannot be estimated (without gravity; see `rb.check_softening`). See `rb.sweep` for
        intervals and attributes.

    Raises
    ------
    CaseError
        If the case is not on a shaker with one harmonic motion, or an argument is not valid.

    Notes
    -----
    With the complex amplitudes F of the force that drives the damper and a of the acceleration of the cavity,

    .. math:: m' - i m'' = \frac{F}{a}, \qquad \eta = \frac{m''}{|m'|}, \qquad w = \frac{W}{m V^2}

    with the loss factor :math:`\eta` and the reduced loss :math:`w`. W is the energy that the damper takes from the shaker
    in a cycle. For particles it is the work of the walls, in which the potential energy of a bed that sinks is not
    included; `rb.analysis.shaken_cavity` has the test of steadiness.

    References
    ----------
    N. Meyer, R. Seifried (2021), Toward a design methodology for particle dampers by analyzing their energy dissipation,
    Computational Particle Mechanics 8, 681-699, doi:10.1007/s40571-020-00363-0.

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
    >>> result = rb.loss_map(case, rb.geomspace("1 mm", "10 mm", 4), ["20 Hz", "40 Hz"])
    >>> result.loss_factor.dims
    ('structure.motion.amplitude', 'structure.motion.frequency')
    """

    kind: ClassVar[str] = "loss_map"
    figure: ClassVar[str] = "rattlebox.plots.loss_map:plot_loss_map"
    report: ClassVar[str] = "rattlebox.report.kinds.loss_map:KIND"

    amplitudes: Annotated[Values, Field(examples=[["1 mm", "2 mm"]])]
    frequencies: Annotated[Values, Field(examples=[{"from": "9 Hz", "to": "11 Hz", "count": 50}])]
    _: KW_ONLY
    cycles: Cycles | None = None
    samples: Samples | None = None

    @cached_property
    def work(self) -> Work:
        """Runs at all amplitudes and frequencies."""
        particles = bool(self.case.particle_dampers)
        names = [name for name in MEASURES if not (particles and name == "impacts_per_cycle")]
        grid, cycles = read_axes(self.case, list(self._axes.values())), self.cycles or CYCLES
        variants = Variants(self.case, grid, names, cycles=cycles, samples=self.samples, intervals=True)
        engine: ParticleEngine | ImpactEngine = (
            ParticleEngine(variants, EXTENSIONS if self.cycles is None else 0)
            if particles
            else ImpactEngine(variants, motion=True)
        )
        return Work(engine, reduction=ForceHarmonics(softening=particles))

    @cached_property
    def _axes(self) -> dict[str, ParsedAxes]:
        """Axes by the name of the field."""
        given = {"amplitudes": {AMPLITUDE: self.amplitudes}, "frequencies": {FREQUENCY: self.frequencies}}
        return {name: parse_axes(self.case, axis, source=name) for name, axis in given.items()}

    def validate(self) -> None:
        """Raise if the fields are not valid; see `Study.validate`."""
        motion = self.case.shaker_motion
        if len(motion) != 1 or list(self.case.harmonics.values()) != list(motion):
            raise Hint("a loss map requires a case on a shaker with one harmonic motion", "a structure of kind shaker")
        if not self.case.dampers:
            raise Hint("a loss map requires a case with a damper", "a ball in a gap, or particles in a cavity")
        for source, axis in self._axes.items():
            for path, column in axis.grid(self.case).columns.items():
                for number, value in enumerate(column):
                    if not value > 0:
                        head = f"{source}: {path}[{number}] = {value:g}"
                        raise CaseError("must be greater than zero", "omit this value", head=head)
        self.work.validate()

    def compute(self) -> xarray.Dataset:
        """Run the sweep; see `Study.compute`."""
        return save_result(self.evaluate(self.run_work(self.work)), self.kind, self.store)

    def evaluate(self, found: xarray.Dataset) -> xarray.Dataset:
        """Return the map from the results of its runs."""
        mass = sum(ball.weight for damper in self.case.impact_dampers for ball in damper.balls)
        mass += sum(float(damper.contents.mass.sum()) for damper in self.case.particle_dampers)
        found = found.assign(particle_mass=((), mass, {"units": "kg", "long_name": "mass of the particles"}))
        return found.assign_attrs(title="Loss map of a damper", **result_notes(self.work, found))


loss_map = study_function(LossMap)
