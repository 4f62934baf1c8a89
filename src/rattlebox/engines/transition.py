"""Derivatives of the state after a stretch of time, with respect to the state before and to parameters of the case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rattlebox._util.exceptions import CaseError
from rattlebox.core import _core
from rattlebox.model.base import Part
from rattlebox.model.case import first_contacts
from rattlebox.model.errors import Hint
from rattlebox.model.paths import get, replaced
from rattlebox.prepare.pack import pack_columns, pack_parts, shape_columns
from rattlebox.prepare.variants import is_number

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from rattlebox.model.case import Case

# Central differences of orders 8 and 6 of the packed numbers, in steps of a part of the size of a parameter. The numbers
# are smooth functions of it, so that both are exact to rounding; where they are not, the two differ. Mode shapes of two
# close frequencies change within a small part of a parameter: for them the steps are smaller, with more rounding.
_STEPS = (0.0025, 0.0025 / 8, 0.0025 / 64, 0.0025 / 512)
_FINE = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
_COARSE = (3 / 4, -3 / 20, 1 / 60, 0.0)
_OFFSETS = (1, -1, 2, -2, 3, -3, 4, -4)

REFUSALS = {
    _core.NotLinear.simultaneous: "simultaneous",
    _core.NotLinear.grazing: "grazing",
    _core.NotLinear.kink: "kink",
    _core.NotLinear.closed: "starts_closed",
}
"""Statuses of a transition whose derivatives do not exist."""


class Touch(NamedTuple):
    """A contact within a transition."""

    time: float
    damper: int
    contact: int
    approach_speed: float
    restitution: float
    is_hard: bool


class Miss(NamedTuple):
    """Where an open contact came closest without touching: time [s], gap [m] and its second derivative [m/s^2]."""

    damper: int
    contact: int
    time: float
    gap: float
    curvature: float


@dataclass(frozen=True)
class Transition:
    """The state after a stretch of time, with its derivatives at fixed times.

    Arrays along several times have them as their first axis; those without are at the last time.
    """

    time: NDArray[np.float64]
    states: NDArray[np.float64]
    rates: NDArray[np.float64]
    derivatives: NDArray[np.float64]
    status: str
    raw: _core.Linearised = field(repr=False)
    is_hard: bool = False
    first_contacts: tuple[int, ...] = ()

    @property
    def state(self) -> NDArray[np.float64]:
        """State at the end."""
        last: NDArray[np.float64] = self.states[-1]
        return last

    @property
    def by_time(self) -> NDArray[np.float64]:
        """Rate of the state at the end."""
        last: NDArray[np.float64] = self.rates[-1]
        return last

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Derivative of the state at the end in the state at the start."""
        part: NDArray[np.float64] = self.derivatives[-1, :, : self.state.size]
        return part

    @property
    def by_parameter(self) -> NDArray[np.float64]:
        """Derivative of the state at the end in the parameters."""
        part: NDArray[np.float64] = self.derivatives[-1, :, self.state.size :]
        return part

    @property
    def ok(self) -> bool:
        """Whether the end was reached and the derivatives exist."""
        return self.status == "finished"

    @cached_property
    def contacts(self) -> list[Touch]:
        """Contacts that began, in their order."""
        log = self.raw.impacts
        columns = (log.time, log.damper, log.contact, log.approach_speed, log.restitution)
        return [
            Touch(float(time), int(damper), int(contact), float(speed), float(e), self.is_hard)
            for time, damper, contact, speed, e in zip(*columns, strict=True)
        ]

    @cached_property
    def closest_approach(self) -> list[Miss]:
        """Closest approach of each contact that came close without touching."""
        misses = []
        for number, (time, gap, curvature) in enumerate(self.raw.miss.tolist()):
            if gap < np.inf:
                damper = int(np.searchsorted(self.first_contacts, number, side="right")) - 1
                misses.append(Miss(damper, number - self.first_contacts[damper], time, gap, curvature))
        return misses

    @property
    def is_closed(self) -> bool:
        """Whether a contact is not open at the end, so that a new transition cannot start there."""
        return bool(self.raw.phases.any())


@dataclass(frozen=True)
class Flow:
    """The motion of a case as a map of its state, which may start at any state and time and with other parameters.

    The state has displacement and velocity of each mode by turns, then the positions of all balls, relative to the base
    and to the closely packed, centred row, then their velocities. Motions start and end in flight.
    """

    case: Case
    parameters: tuple[str, ...]
    values: NDArray[np.float64]
    names: tuple[str, ...]
    _first_contacts: tuple[int, ...]
    _step: float = _STEPS[0]

    @classmethod
    def of(cls, case: Case, parameters: Sequence[str] = ()) -> Flow:
        """Return the flow of a case, with derivatives in the numbers at some paths.

        Raises
        ------
        CaseError
            If the case has particles or no impact dampers and stops, its method is TwoStep, or a path is not that of a
            number that can vary.
        """
        if case.particle_dampers:
            raise Hint("derivatives of a motion are those of impact dampers, not of particles", "finite differences")
        if not case.method.has_stepper:
            raise Hint(f"the method {type(case.method).__name__} has no derivatives", "EventDriven or Newton")
        values = []
        for path in parameters:
            value = get(case, path)
            number = value[0] if isinstance(value, tuple) and len(value) == 1 else value
            if isinstance(number, Part):  # a number in place of a law is its only coefficient
                number = getattr(number, "e", None)
            if isinstance(number, bool) or not isinstance(number, (int, float)):
                raise CaseError(
                    f"{path}: a derivative needs a number, not {value!r:.60}",
                    "a path of one number, such as damper.gap",
                )
            values.append(float(number))
        # Gives each number a field of its own: that of a ratio, for instance, in place of a value.
        whole = replaced(case, dict(zip(parameters, values, strict=True))) if parameters else case
        for path in parameters:
            if not is_number(whole, path, np.zeros(1)):
                raise Hint(
                    f"{path}: whole numbers, entries of tables and pulses of straight lines have no derivatives",
                    "finite differences, or for a pulse HalfSine",
                )
        modes = case.modes.decay.size
        balls = [
            f"{damper.label(i)}/{k + 1}"
            for i, damper in enumerate(case.impact_dampers)
            for k in range(len(damper.balls))
        ]
        names = (
            *(f"{what} of mode {k + 1}" for k in range(modes) for what in ("displacement", "velocity")),
            *(f"position of {ball}" for ball in balls),
            *(f"velocity of {ball}" for ball in balls),
        )
        flow = cls(whole, tuple(parameters), np.array(values), names, tuple(first_contacts(case)))
        # Compares a batch with cases that are packed one by one: formulas must take arrays.
        pack_parts(whole, {path: np.full(2, value) for path, value in zip(parameters, values, strict=True)}, (2,))
        flows = (replace(flow, _step=step) for step in _STEPS)
        return next((each for each in flows if each.start().status != "kink"), flow)

    def start(self, values: ArrayLike | None = None) -> Transition:
        """Return the state at the start of the case, with its derivatives in the parameters."""
        return self.along(None, 0.0, [0.0], values)

    def over(
        self,
        state: ArrayLike | None,
        start_time: float,
        duration: float,
        values: ArrayLike | None = None,
        derivatives: bool = True,
    ) -> Transition:
        """Return the state after a duration [s], with its derivatives; state None is the start of the case."""
        return self.along(state, start_time, [start_time + duration], values, derivatives)

    def along(
        self,
        state: ArrayLike | None,
        start_time: float,
        times: ArrayLike,
        values: ArrayLike | None = None,
        derivatives: bool = True,
    ) -> Transition:
        """Return the states at increasing times [s], with their derivatives in the state at the start and parameters."""
        own = self.values if values is None else np.asarray(values, dtype=float)
        packed = pack_columns(self.case, self._columns(own) if derivatives else self._fixed(own))
        fine, coarse = self._weights() if derivatives else (np.zeros((0, 1)), np.zeros((0, 1)))
        start = None if state is None else np.ascontiguousarray(state, dtype=float)
        raw = _core.linearise(
            packed, start, start_time, np.ascontiguousarray(times, dtype=float), fine, coarse, derivatives
        )
        slopes = raw.derivative
        if derivatives and self.parameters:
            slopes[:, :, len(self.names) :] /= self._sizes(own)
        status = REFUSALS.get(raw.refused) or raw.status.name
        hard = self.case.method.kind == "newton"
        return Transition(raw.time, raw.state, raw.rate, slopes, status, raw, hard, self._first_contacts)

    def variants(self, values: ArrayLike | None = None) -> _core.Problem:
        """Return the packed case in the variants of the differences in its parameters, the case itself first."""
        return pack_columns(
            self.case, self._columns(self.values if values is None else np.asarray(values, dtype=float))
        )

    def shape(self, point: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the mode shapes at a point, (m,), and their derivatives in the parameters, (m, p)."""
        shapes = shape_columns(self.case, self._columns(self.values), point)
        return shapes[:, 0], self.slopes(shapes)

    def slopes(self, variants: ArrayLike, values: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return the derivatives in the parameters of numbers in all variants of `variants`, (..., p)."""
        fine, _ = self._weights()
        numbers = np.asarray(variants, dtype=float)
        whole = np.broadcast_to(numbers, (*numbers.shape[:-1], fine.shape[1]))
        sizes = self._sizes(self.values if values is None else np.asarray(values, dtype=float))
        slopes: NDArray[np.float64] = (whole - whole[..., :1]) @ fine.T / sizes
        return slopes

    def _sizes(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(values == 0, 1.0, np.abs(values))

    def _fixed(self, values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        return {path: values[i : i + 1] for i, path in enumerate(self.parameters)}

    def _columns(self, values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Return the values of each parameter in the variants: those of the case, then those of each difference."""
        columns = {}
        for i, (path, size) in enumerate(zip(self.parameters, self._sizes(values), strict=True)):
            column = np.full(1 + 8 * len(self.parameters), values[i])
            column[1 + 8 * i : 9 + 8 * i] += np.array(_OFFSETS) * (self._step * size)
            columns[path] = column
        return columns

    def _weights(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the weights of the variants in each derivative, of orders 8 and 6."""
        count = len(self.parameters)
        both = np.zeros((2, count, 1 + 8 * count))
        for order, weights in enumerate((_FINE, _COARSE)):
            signed = np.array([side * w for w in weights for side in (1, -1)]) / self._step
            for i in range(count):
                both[order, i, 1 + 8 * i : 9 + 8 * i] = signed
        return both[0], both[1]
