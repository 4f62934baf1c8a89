"""Notches of test levels for structures with dampers, whose force on the base is not in proportion to the level."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rattlebox._util.narrow import instance
from rattlebox.analysis.notching import PER_OCTAVE, Notched, SineTable, notch
from rattlebox.analysis.power_spectra import transfer_function
from rattlebox.analysis.signals import first_harmonic, trapezoid_weights
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.methods import Output
from rattlebox.model.signals import Signal
from rattlebox.model.units import in_si, whole_number
from rattlebox.studies.run.runner import evaluate_cases
from rattlebox.studies.run.study import whole_cycles

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from rattlebox.model.case import Case
    from rattlebox.results.run import Run

    FloatArray = NDArray[np.float64]

_SAMPLES = 64
"""Samples in a cycle of a sine level, and in one of the highest frequency of random vibration a quarter of it."""
_NEAR, _FAR = 48, 6
"""Frequencies in an octave of a sine level: within a quarter of an octave of a natural frequency, and elsewhere."""
_SHARE = 0.5
"""Share of the correction in decibels that is made from the second round on, so that levels do not swing about the limit."""


def notch_with_dampers(
    profile: Signal | Sequence[Any],
    case: Case,
    *,
    force: float | str | None = None,
    force_density: float | str | None = None,
    force_rms: float | str | None = None,
    tolerance: float = 0.5,
    rounds: int = 20,
    cycles: tuple[int, int] = (60, 20),
    resolution: float | None = None,
    backend: Any = "threads",
    workers: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> Notched:
    r"""Reduce a random or sine profile so that the force of a structure with dampers on its base stays within a limit.

    Each round runs the case at the present level and computes the notch from the apparent mass that it has there, until the
    level that was run and the one that follows from it agree.

    Parameters
    ----------
    profile
        Base acceleration, as for `rattlebox.analysis.notch`.
    case
        Case with dampers. Its base motion and duration are replaced, its loads must be none.
    force, force_density, force_rms
        Limit, as for `rattlebox.analysis.notch`.
    tolerance
        Largest difference between the level that was run and the one that follows from it [dB].
    rounds
        Largest number of rounds.
    cycles
        Numbers of cycles to skip and to evaluate at each frequency of a sine profile.
    resolution
        Resolution of the apparent mass under random vibration [Hz]; see `rattlebox.analysis.transfer_function`.
    backend, workers, progress
        Execution; see `rattlebox.studies.run.study.Study`.

    Returns
    -------
    Notched
        As from `rattlebox.analysis.notch`, at the level of the last round. `levels.attrs` has `rounds`, the largest
        `difference` [dB], and `reached`, the largest force in the last round over the limit: of the first harmonics of a
        sine profile, or the RMS force of random vibration with `force_rms`.

    Raises
    ------
    CaseError
        If the limit does not fit the profile, the case has loads or no participation of its modes, or a run fails.

    Warns
    -----
    UserWarning
        If the levels do not agree within the tolerance after the last round.

    Notes
    -----
    With the apparent mass :math:`M(\omega, A)` at the level A the notched level solves

    .. math:: A' = \min\left(A, \frac{F}{|M(\omega, A')|}\right)

    Rounds after the first correct the level by half of the difference in decibels. A sine profile is run at 48
    frequencies an octave near natural frequencies, and 6 elsewhere; each run is steady vibration from the start of the
    case. The limit is that of the first harmonic of the force: impacts exceed it for moments. The apparent mass of random
    vibration is the transfer function from the acceleration of the base to the force, so that the part of the force that
    is not coherent is outside of the limit.

    References
    ----------
    NASA-HDBK-7004C (2012), Force limited vibration testing.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.Case(
    ...     structure=rb.SDOF(mass="2 kg", frequency="100 Hz", damping_ratio=0.05),
    ...     damper=rb.ImpactDamper(
    ...         ball=rb.Sphere(diameter="30 mm", material="steel"), gap="0.2 mm", contact=rb.Tsuji(restitution=0.5)
    ...     ),
    ...     duration="1 s",
    ... )
    >>> found = rb.notch_with_dampers([("80 Hz", "2 g"), ("125 Hz", "2 g")], case, force="150 N", progress=False)
    >>> found.levels.attrs["difference"] <= 0.5
    True
    """
    if case.loads:
        raise Hint(
            "the case has loads; the force on the base must be that of the base motion alone", "loads = ()", ["loads"]
        )
    limits = {"force": force, "force_density": force_density, "force_rms": force_rms}
    most = whole_number(rounds, "rounds", 1)
    if not (isinstance(tolerance, (int, float)) and 0 < tolerance < math.inf):
        raise Hint(f"tolerance = {tolerance!r:.40}: a number of decibels above zero is needed", "0.5", ["tolerance"])
    test = profile if isinstance(profile, Signal) else SineTable(profile)
    run = partial(evaluate_cases, backend=backend, workers=workers, progress=progress)
    first = notch(profile, case.without_dampers(), **limits)  # raises if the limit does not fit
    rig = (
        _RandomRig(case, test, run, resolution) if test.is_density else _SineRig(case, test, run, whole_cycles(cycles))
    )
    found, difference = first, math.inf
    level = rig.level_of(first)
    for number in range(1, most + 1):
        mass, force_of_run = rig.measure(level)
        found = notch(profile, mass, **limits)
        wanted = rig.level_of(found)
        difference = float(rig.per_decade * np.abs(np.log10(wanted / level)).max())
        if difference <= tolerance or number == most:
            break
        level = level * (wanted / level) ** (1.0 if number == 1 else _SHARE)
    if difference > tolerance:
        warnings.warn(
            f"the notch has not settled: after {most} rounds the level that was run and the one that follows from it differ "
            f"by {difference:.2g} dB, more than {tolerance:g} dB; try: more cycles, a longer random signal, or a "
            "larger tolerance",
            stacklevel=2,
        )
    limit = found.levels.attrs["limit"] if force_rms is None else in_si(force_rms, "N")
    attrs: dict[str, Any] = {"rounds": number, "difference": difference}
    if force_density is None:
        attrs["reached"] = force_of_run / limit
    return replace(found, levels=found.levels.assign_attrs(attrs))


class _Measured(NamedTuple):
    """Apparent mass over frequency, and the largest force of the runs."""

    mass: xarray.DataArray
    force: float


@dataclass
class _SineRig:
    """Runs of steady vibration at single frequencies."""

    case: Case
    test: Any
    run: Callable[..., list[Any]]
    cycles: tuple[int, int]

    per_decade = 20.0

    @cached_property
    def frequencies(self) -> FloatArray:
        """Frequencies of the runs [Hz]."""
        low, high = self.test.levels[[0, -1], 0]
        modes = self.case.modes
        natural = np.sqrt(np.maximum(modes.stiffness, 0.0)) / (2 * np.pi)
        far = np.geomspace(low, high, 1 + math.ceil(_FAR * math.log2(high / low)))
        near = [f * 2 ** np.arange(-0.25, 0.25 + 0.5 / _NEAR, 1 / _NEAR) for f in natural]
        found = np.unique(np.concatenate([far, natural, *near]))
        return np.asarray(np.concatenate([[low], found[(found > low) & (found < high)], [high]]))

    def level_of(self, found: Notched) -> FloatArray:
        """Return the amplitudes at the frequencies of the runs [m/s^2]."""
        return _interpolated(found, self.frequencies)

    def measure(self, level: FloatArray) -> _Measured:
        """Return the apparent mass at a level."""
        cases = []
        for frequency, amplitude in zip(self.frequencies, level, strict=True):
            along = {"direction": self.test.direction} if self.test.direction else {}
            base = Harmonic(amplitude=float(amplitude), frequency=float(frequency), **along)
            output = Output(rate=_SAMPLES * frequency)
            cases.append(self.case.replaced({"base": base, "duration": sum(self.cycles) / frequency, "output": output}))
        masses = self.run(cases, partial(_apparent_mass, kept=self.cycles[1]))
        for one in masses:
            _require(one)
        values = np.array(masses)
        return _Measured(_over(self.frequencies, values), float((np.abs(values) * level).max()))


@dataclass
class _RandomRig:
    """A run of random vibration."""

    case: Case
    test: Any
    run: Callable[..., list[Any]]
    resolution: float | None

    per_decade = 10.0

    @cached_property
    def frequencies(self) -> FloatArray:
        """Frequencies of the levels [Hz]."""
        low, high = self.test.levels[[0, -1], 0]
        even = np.geomspace(low, high, 1 + math.ceil(PER_OCTAVE * math.log2(high / low)))
        found = np.unique(np.concatenate([even[1:-1], self.test.levels[:, 0]]))
        return np.asarray(found[np.append(True, np.diff(found) > 1e-9 * high)])

    def level_of(self, found: Notched) -> FloatArray:
        """Return the densities at the frequencies of the levels [(m/s^2)^2/Hz]."""
        return _interpolated(found, self.frequencies)

    def measure(self, level: FloatArray) -> _Measured:
        """Return the apparent mass at a level."""
        base = self.test.with_levels(np.stack([self.frequencies, level], axis=1))
        output = Output(rate=0.25 * _SAMPLES * self.frequencies[-1])
        case = self.case.replaced({"base": base, "duration": base.duration, "output": output})
        (found,) = self.run([case], partial(_transfer, resolution=self.resolution))
        _require(found)
        return _Measured(*found)


def _interpolated(found: Notched, frequencies: FloatArray) -> FloatArray:
    levels = found.levels
    return np.asarray(np.exp(np.interp(np.log(frequencies), np.log(levels.frequency), np.log(levels.after))))


def _over(frequencies: FloatArray, values: Any) -> xarray.DataArray:
    import xarray

    return xarray.DataArray(values, {"frequency": frequencies}, ("frequency",))


def _require(found: object) -> None:
    if isinstance(found, str):
        raise Hint(f"a run failed: {found}", "rb.simulate(case) with the base motion, to see where")


def _apparent_mass(run: Run, kept: int) -> complex | str:
    """Return the force on the base over its acceleration in the last cycles of a run [kg]; a message if it failed."""
    if not run.ok:
        return run.message
    base = run.case.base[0]
    motion, frequency = run.along(base.direction), instance(base, Harmonic).frequency
    time = run.arrays.time
    weights = trapezoid_weights(time, time[-1] - kept / frequency)
    force, acceleration = (
        first_harmonic(time, each.values, weights, frequency)
        for each in (motion.interface_force, motion.base_acceleration)
    )
    return complex(force / acceleration)


def _transfer(run: Run, resolution: float | None) -> tuple[xarray.DataArray, float] | str:
    """Return the apparent mass over frequency and the RMS force of a run; a message if it failed."""
    if not run.ok:
        return run.message
    motion = run.along(run.case.base[0].direction)
    found = transfer_function(motion.time, motion.base_acceleration, motion.interface_force, resolution=resolution)
    return found.transfer, float(motion.interface_force.std())
