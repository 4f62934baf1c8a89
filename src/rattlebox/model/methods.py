"""Numerical methods and output times."""

from __future__ import annotations

import operator
from abc import abstractmethod
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator

from .base import Part
from .contacts import Contact, FixedDamping
from .elementwise import Vector
from .errors import Hint, at
from .kinds import AnyKind
from .pairs import Pair
from .restitutions import AnyRestitution, Restitution
from .units import Number, PositiveFrequency, PositiveTime, Whole, numbers, parse


class Method(Part):
    """Base class of numerical methods."""

    field_names: ClassVar[tuple[str, ...]] = ("method",)
    kinds: ClassVar[dict[str, type[Part]]] = {}
    # Whether all errors of the energy are rounding errors, because no contact is integrated.
    is_exact: ClassVar[bool] = False
    kind: str

    @property
    @abstractmethod
    def has_stepper(self) -> bool:
        """Whether the method can advance a case step by step in the time loop of another program."""

    def hard_restitution(self, contact: Contact, pair: Pair) -> Restitution | FixedDamping | None:
        """Return the restitution of impacts that take no time; None if contacts have a duration."""
        return None


class ImpactMethod(Method):
    """Base class of methods of impact dampers."""

    kind: str

    @abstractmethod
    def settings(self) -> tuple[str, dict[str, Any]]:
        """Return the name of the method in the core and its settings, by name."""


class EventDriven(ImpactMethod):
    r"""Exact flights and contacts integrated with error control: the default method of impact dampers.

    Parameters
    ----------
    tolerance
        Relative error of one step of the integration of a contact.
    max_events
        Largest number of flights and contacts; a run that reaches it ends with the status "too_many_events".
    collocation
        Whether single Hertz contacts are solved by collocation; False integrates them step by step, which is slower.

    Notes
    -----
    A flight is the closed solution of each mode,

    .. math:: \ddot q + 2 a \dot q + k q = f(t)

    and a parabola of each ball; it ends at the first root of a distance, which is bracketed with a bound of the relative
    acceleration so that no contact is missed. A contact is integrated by DOP853. A single Hertz contact is integrated in
    :math:`x = d^{1/4}`, with the overlap :math:`d`, which removes the singularity of the dashpot at the first touch, by
    collocation at Gauss-Legendre nodes.

    References
    ----------
    E. Hairer, S. P. Nørsett and G. Wanner (1993), Solving Ordinary Differential Equations I, 2nd ed., Springer, sections
    II.5 and II.10 (DOP853), doi:10.1007/978-3-540-78862-1.

    J.-P. Berrut and L. N. Trefethen (2004), SIAM Review 46, 501-517, doi:10.1137/S0036144502417715 (interpolation between
    nodes).
    """

    kind: Literal["event_driven"] = "event_driven"
    tolerance: Annotated[Number, Field(ge=1e-14, le=1e-3)] = 1e-12
    max_events: Annotated[Whole, Field(ge=1)] = 10_000_000
    collocation: bool = True

    @property
    def has_stepper(self) -> bool:
        """True."""
        return True

    def settings(self) -> tuple[str, dict[str, Any]]:
        """Return the tolerance, the limit of events and the choice of collocation."""
        values = {"tolerance": self.tolerance, "max_events": self.max_events, "collocation": self.collocation}
        return "event_driven", values


class TwoStep(ImpactMethod):
    r"""Fixed steps, long in flight and short in contact, as in discrete-element programs; for comparison.

    Parameters
    ----------
    dt_flight, dt_contact
        Time steps in flight and in contact [s].
    inner
        "rk4": one Runge-Kutta step; "dopri5": an adaptive solution within each step, with the default tolerances of MATLAB's
        ode45.

    Notes
    -----
    Each step integrates :math:`\dot y = f(t, y)` of all modes and balls, with dt_contact if a contact is closed
    at its beginning and dt_flight otherwise. A contact begins and ends at the end of a step: the overlap at its beginning
    is up to V dt_flight.

    References
    ----------
    J. R. Dormand and P. J. Prince (1980), A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6, 19-26,
    doi:10.1016/0771-050X(80)90013-3.
    """

    kind: Literal["two_step"] = "two_step"
    dt_flight: PositiveTime = 5e-6
    dt_contact: PositiveTime = 3e-8
    inner: Literal["rk4", "dopri5"] = "rk4"

    @property
    def has_stepper(self) -> bool:
        """False: its steps are not those of the other program."""
        return False

    def settings(self) -> tuple[str, dict[str, Any]]:
        """Return both steps and the choice of the inner solution."""
        steps = {"dt_flight": self.dt_flight, "dt_contact": self.dt_contact}
        return "two_step", {**steps, "adaptive_inner": self.inner == "dopri5"}


class Newton(ImpactMethod):
    r"""Instantaneous (hard) impacts, for comparison with theory.

    Parameters
    ----------
    restitution
        Restitution law, or a number from 0 to 1; default that of the contact.
    stick
        Threshold of sticking. Two bodies stick if their next flight would be shorter than this part of the shortest period
        of modes and loads; they do not rebound if they approach more slowly than this part of the largest speed of a ball in
        its cavity so far.
    max_events
        Largest number of flights and impacts.

    Notes
    -----
    An impact exchanges momentum in no time: the bodies separate with :math:`v' = e(v)\, v`, their approach speed
    :math:`v` times the restitution :math:`e`. Impacts at the same time are resolved together, with impulses :math:`p`:

    .. math:: p \ge 0, \qquad v' \ge e v, \qquad p\, (v' - e v) = 0

    References
    ----------
    C. Glocker and F. Pfeiffer (1995), Nonlinear Dynamics 7, 471-497, doi:10.1007/BF00121109.

    B. Brogliato (2016), Nonsmooth Mechanics, 3rd ed., Springer, doi:10.1007/978-3-319-28664-8.

    Examples
    --------
    >>> import rattlebox as rb
    >>> case = rb.reference_case(contact=rb.Tsuji(restitution=0.5), method=rb.Newton(), duration="0.1 s")
    >>> impacts = rb.simulate(case).arrays.impacts
    >>> bool((impacts.separation_speed == 0.5 * impacts.approach_speed).all())
    True
    """

    is_exact: ClassVar[bool] = True
    kind: Literal["newton"] = "newton"
    restitution: AnyRestitution | None = None
    stick: Annotated[Number, Field(ge=0, le=0.1)] = 1e-6
    max_events: Annotated[Whole, Field(ge=1)] = 10_000_000

    @property
    def has_stepper(self) -> bool:
        """True."""
        return True

    def hard_restitution(self, contact: Contact, pair: Pair) -> Restitution | FixedDamping:
        """Return the restitution of the method; by default that of the contact."""
        return self.restitution or contact.equivalent_restitution(pair)

    def settings(self) -> tuple[str, dict[str, Any]]:
        """Return the threshold of sticking and the limit of events."""
        return "newton", {"stick": self.stick, "max_events": self.max_events}


def _step(value: object) -> Any:
    return value if value == "auto" else parse(value, ("s",))[0]


class Dem(Method):
    r"""Discrete-element method with fixed steps: the method of particle dampers.

    Parameters
    ----------
    dt
        Time step [s], or "auto". It is shortened slightly so that samples fall on steps. A step that is too long for an
        expected contact raises an error.
    fraction
        Automatic step over the duration of the shortest contact or the period of the fastest mode.
    threads
        Number of threads; by default it depends on the cores and the number of particles. Results are bitwise independent of
        the number.
    checkpoint
        Interval between checkpoints in wall-clock time [s], if the run has a checkpoint file; default ten minutes.
    checkpoint_every
        Interval between checkpoints in simulated time [s], in place of `checkpoint`.

    Notes
    -----
    .. math:: m_i \ddot x_i = \sum_j F_{ij} + m_i g, \qquad I_i \dot\omega_i = \sum_j M_{ij}

    with the forces and moments of the contacts of each particle, and the modes of the structure, are integrated in steps
    by the velocity-Verlet method. Forces that depend on the velocity use one that is extrapolated from
    the previous step, which keeps second order.

    References
    ----------
    P. A. Cundall and O. D. L. Strack (1979), A discrete numerical model for granular assemblies, Géotechnique 29, 47-65,
    doi:10.1680/geot.1979.29.1.47.

    W. C. Swope, H. C. Andersen, P. H. Berens and K. R. Wilson (1982), J. Chem. Phys. 76, 637-649, doi:10.1063/1.442716
    (velocity Verlet).
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("checkpoint", "checkpoint_every"),)
    kind: Literal["dem"] = "dem"
    dt: Annotated[
        Literal["auto"] | float,
        BeforeValidator(_step),
        WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}], "description": "step in s, or auto"}),
    ] = "auto"
    fraction: Annotated[Number, Field(gt=0, le=0.2)] = 0.025
    threads: Annotated[Whole, Field(ge=1)] | None = None
    checkpoint: PositiveTime | None = None
    checkpoint_every: PositiveTime | None = None

    @field_validator("dt")
    @classmethod
    def _forward(cls, dt: float | str) -> float | str:
        if isinstance(dt, float) and not dt > 0:
            raise Hint("must be greater than zero", '"auto", or a time such as "1 us"')
        return dt

    @model_validator(mode="after")
    def _one_clock(self) -> Dem:
        if self.checkpoint is not None and self.checkpoint_every is not None:
            raise Hint("checkpoint and checkpoint_every exclude each other", "one of them", ["checkpoint_every"])
        return self

    @property
    def has_stepper(self) -> bool:
        """True."""
        return True


AnyMethod = Annotated[Method, AnyKind()]


DEFAULT_SNAPSHOTS = 101


def _times(value: object) -> Any:
    if value is None:
        return None
    if isinstance(value, np.ndarray) and value.dtype.kind in "iuf":
        return tuple(np.unique(numbers(value)).tolist())
    times = set()
    for index, item in enumerate(np.asarray(value, dtype=object).ravel().tolist()):
        with at(index):
            times.add(parse(item, ("s",))[0])
    return tuple(sorted(times))


def _count_or_times(value: Any) -> Any:
    if isinstance(value, (bool, np.bool_, str, float, np.floating)):
        raise Hint("a number of snapshots is needed, or a list of times", "snapshots = 100")
    try:
        count = operator.index(value)
    except TypeError:
        return _times(value)
    if count < 2:
        raise Hint("at least two snapshots are needed, at 0 and at the end", "snapshots = 100")
    return count


class Output(Part):
    """Times at which motion and energies are recorded, always with 0 and the end. They do not affect the run.

    The default times resolve the motion for figures: evenly spaced, 2001 of them or 20 in each period of the fastest mode or
    harmonic (up to 100 001); 20 in each pulse; and, in runs of up to 200 000 events, start, deepest overlap and end of every
    contact and the middle of the flights before and after it. Spectra need evenly spaced times, set by a rate.

    Parameters
    ----------
    rate
        Sampling rate [Hz].
    times
        Sample times [s], in place of a rate. With particle dampers they are evenly spaced, together with 0 and the end.
    snapshots
        Number of snapshots of the particles, evenly spaced from 0 to the end, or their times [s], in runs with particle
        dampers and a snapshot file; default 101. An empty list is none.
    walls
        Whether forces, moments, losses and impacts are recorded for each face of the cavities with particles.

    Examples
    --------
    >>> import rattlebox as rb
    >>> run = rb.simulate(rb.reference_case(duration="0.1 s", output=rb.Output(rate="2 kHz")))
    >>> run.arrays.time[:3]
    array([0.    , 0.0005, 0.001 ])
    """

    field_names: ClassVar[tuple[str, ...]] = ("output",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("rate", "times"),)
    rate: PositiveFrequency | None = None
    times: Annotated[tuple[float, ...] | None, BeforeValidator(_times)] = None
    snapshots: Annotated[int | tuple[float, ...] | None, BeforeValidator(_count_or_times)] = None
    walls: bool = False

    @model_validator(mode="after")
    def _one_of_both(self) -> Output:
        if self.rate is not None and self.times is not None:
            raise Hint("rate and times exclude each other", "one of them", ["times"])
        return self

    @field_validator("times", "snapshots")
    @classmethod
    def _not_before(cls, times: tuple[float, ...] | int | None) -> tuple[float, ...] | int | None:
        if isinstance(times, tuple) and times and times[0] < 0:
            raise Hint("output times must not be negative", "times from 0 to the end of the run")
        return times

    @property
    def is_chosen(self) -> bool:
        """Whether a rate or times are set."""
        return self.rate is not None or self.times is not None

    def sample_times(self, duration: float, fastest: float = 0.0, start: float = 0.0) -> Vector:
        """Return the sample times of a run that are known in advance; by default the evenly spaced ones.

        Parameters
        ----------
        duration
            Duration of the run [s].
        fastest
            Highest frequency of the case [Hz], for the default times.
        start
            First time, of a run that continues another one [s].

        Returns
        -------
        (T,) float
            Times [s].
        """
        if self.times is not None:
            inside = [
                t for t in self.times if start < t < duration * (1 - 1e-12)
            ]  # 8 x 0.1 may be slightly less than 0.8
            return np.array([start, *inside, duration])
        if self.rate is None:
            return np.linspace(start, duration, 1 + int(np.clip(20 * (duration - start) * fastest, 2000, 100_000)))
        # The tolerance is for rounding: 10 000 steps of 0.1 ms may be slightly less than 1 s.
        before = max(1, int(np.ceil(duration * self.rate - 1e-6)))
        after = int(start * self.rate + 1e-6) + 1
        return np.concatenate([[start], np.arange(after, before) / self.rate, [duration]])

    def snapshot_times(self, duration: float) -> Vector:
        """Return the times of the snapshots of a run, (n,) [s].

        Parameters
        ----------
        duration
            Duration of the run [s].
        """
        if isinstance(self.snapshots, tuple):
            return np.array(self.snapshots)
        return np.linspace(0.0, duration, self.snapshots or DEFAULT_SNAPSHOTS)
