"""Dampers in the time loop of another program."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rattlebox._util.exceptions import CaseError, StepError
from rattlebox._util.quantities import quantity
from rattlebox.core import _core
from rattlebox.model.case import Case, first_contacts
from rattlebox.model.dampers import ImpactDamper
from rattlebox.model.errors import Hint
from rattlebox.model.methods import Method
from rattlebox.model.particle_damper import ParticleDamper
from rattlebox.model.signals import Signal
from rattlebox.model.units import Quantity, in_si
from rattlebox.prepare.component import damper_case, pack_component
from rattlebox.prepare.time_step import step_diagnostics

from .run_notes import component_notes, table_notes
from .status import describe


@dataclass(frozen=True)
class StepResult:
    """Result of one step of a stepper.

    Attributes
    ----------
    force
        Mean force of the damper on the structure: impulse / length of the step [N]. A number for an impact damper alone,
        (3,) for a particle damper alone; with a structure (dampers,) or (dampers, 3), and behind the dampers the stops of
        the case, each with the force on its point.
    moment
        Mean moment on the structure about the attachment [N m], (3,); zero for impact dampers, whose balls move along a line
        through it. Only for a damper alone.
    work
        Work done in the step [J]: by the attachment on the damper, or by the loads on the structure.
    loss
        Energy lost in the step [J].
    stored
        Energy stored at the end of the step [J]: kinetic, elastic and potential, in the frame of the base. Its change in the
        step is work - loss, which is checked in every step; see `Stepper`.
    """

    force: Any
    moment: NDArray[np.float64]
    work: float
    loss: float
    stored: float


def component_case(
    system: Case | ImpactDamper | ParticleDamper,
    alone: bool | None = None,
    method: Any = None,
    motion: Signal | None = None,
    structure_mass: Any = None,
) -> tuple[Case, bool]:
    """Return the case of a component, and whether it is a damper alone; see `Stepper` for the parameters."""
    if not isinstance(system, Case):
        return damper_case(system, method, motion, structure_mass, "1 s"), True
    for name, option in (("method", method), ("motion", motion), ("structure_mass", structure_mass)):
        if option is not None:
            raise Hint(f"{name} belongs to a damper alone; a case has its own", f"the damper alone, with {name}=...")
    return system, not system.structure.responds if alone is None else alone


class Stepper:
    """A damper, or a structure with dampers, that another program advances step by step.

    Parameters
    ----------
    system
        A damper alone: `advance` takes the motion of its attachment and returns the force on it. Or a case: its loads and
        base accelerations are the inputs of `advance`, and the motion of its points the outputs.
    alone
        Whether only the damper of a case is advanced. The contacts are then adjusted to the structure of the case, and the
        softening and the time step of particles chosen for its loads. By default for the structures `Fixed` and `Shaker`.
    method
        Method for a damper alone; default that of `Case`.
    motion
        Largest expected motion of the attachment of a particle damper, a signal as in `Shaker`. The softening and the time
        step are chosen for it.
    structure_mass
        Effective mass of the structure at the attachment of an impact damper [kg]; default rigid. The dashpots of the
        contacts are adjusted to it, as `simulate` does.
    velocity
        Initial velocity of the attachment [m/s], a number or three components for particles; default 0. Balls and particles
        start with their own velocity, whatever that of the attachment.

    Raises
    ------
    CaseError
        If the case is not valid or its method has no stepper.

    See Also
    --------
    simulate : Runs a case as a whole, which is more accurate and faster.

    Notes
    -----
    The acceleration of the attachment, and each load, is constant in a step. For a smooth motion the error decreases with
    the square of the step. Contacts continue from one step to the next. The mean force of a step of the length H follows
    from the absolute momentum P of the particles or balls of the mass M, whose weight is M g,

        F = M g - (P_1 - P_0) / H

    At the end of every step the energy balance is checked, E - E_0 = W - L with the stored energy E, the work W and the loss
    L. An imbalance above 1 % of the energy put in (that of the motion at the start, plus the largest work and the largest
    change of potential energy so far) is the status `energy_error` and raises `StepError`, as in whole runs.

    Examples
    --------
    >>> import rattlebox as rb
    >>> ball = rb.Sphere(radius="10 mm", material="steel")
    >>> damper = rb.ImpactDamper(ball=ball, gap="2 mm", contact=rb.Tsuji(restitution=0.6))
    >>> stepper = rb.Stepper(damper, velocity=0.3)
    >>> abs(stepper.advance(0.005, velocity=0.3).force) < 1e-9  # the ball does not touch yet
    True
    >>> stepper.advance(0.01, velocity=0.3).force < 0  # it has hit the trailing wall
    True
    """

    def __init__(
        self,
        system: Case | ImpactDamper | ParticleDamper,
        *,
        alone: bool | None = None,
        method: Method | None = None,
        motion: Signal | None = None,
        structure_mass: Quantity | None = None,
        velocity: Quantity | ArrayLike = 0.0,
    ) -> None:
        case, alone = component_case(system, alone, method, motion, structure_mass)
        start = np.asarray(in_si(velocity, "m/s"), dtype=np.float64)
        self._packed = pack_component(case, alone=alone, velocity=start)
        if not alone and start.any():
            raise Hint("velocity belongs to a damper alone", "the initial velocity of the structure")
        self._case = case
        try:
            self._core = _core.Stepper(self._packed.data)
        except ValueError as error:
            raise StepError(str(error), "positions, velocities and laws with which a run starts") from None

    @property
    def time(self) -> float:
        """Time at the end of the last step [s]."""
        return float(self._core.time)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs: the accelerations of the attachment, or the loads and base accelerations of the case."""
        return self._packed.inputs

    @property
    def points(self) -> tuple[str, ...]:
        """Names of the points whose motion is an output; none for a damper alone."""
        return self._packed.outputs

    @property
    def packed(self) -> bytes:
        """The packed case, for the C interface."""
        return self._packed.data

    @property
    def energy_residual(self) -> float:
        """Largest imbalance of the energies so far, over the energy put in."""
        return float(self._core.energy_residual)

    @property
    def notes(self) -> tuple[str, ...]:
        """Choices that were made for the case, and warnings, like `Run.notes`.

        Warnings are about a structure that is light against the damper, about an initial velocity that was probably
        forgotten, and about contacts since the start: overlaps beyond the range of the contact laws, speeds beyond a table
        of restitution, and a time step that is too long for contacts of particles, because they move faster than with
        `motion`.
        """
        return (*self._start_notes(), *self._contact_notes())

    def _start_notes(self) -> Iterator[str]:
        """Yield a warning if the velocity of the attachment jumped in the first step, and did not change in the second."""
        jump = self._core.start_jump
        if jump > 0:
            yield (
                f"warning: the velocity of the attachment changed by {quantity(jump, 'm/s', 3)} in the first step and "
                "hardly in the second, as if its initial value had been forgotten: give it as Stepper(..., velocity=...)"
            )

    def _contact_notes(self) -> tuple[str, ...]:
        overlaps, speeds = self._core.largest_overlap, self._core.largest_approach_speed
        prepared = self._packed.prepared
        if prepared is None:
            return (*self._packed.notes, *component_notes(self._case, overlaps, speeds))
        case, tables, step = prepared.case, prepared.tables, prepared.step
        notes = step_diagnostics(case, tables, step, overlaps.tolist(), speeds.tolist())[1]
        return (*notes, *self._packed.notes, *table_notes(case, speeds.tolist()))

    def advance(
        self,
        to: Quantity,
        *,
        velocity: Quantity | ArrayLike | None = None,
        acceleration: Quantity | ArrayLike | None = None,
        loads: ArrayLike | None = None,
    ) -> StepResult:
        """Advance to a time.

        Parameters
        ----------
        to
            Time at the end of the step [s]; after the current time.
        velocity
            Velocity of the attachment at the end of the step [m/s], for a damper alone: a number, or three components for
            particles.
        acceleration
            Acceleration of the attachment during the step [m/s^2], instead of the velocity.
        loads
            Mean value of each load and base acceleration during the step [N], [m/s^2], for a case with a structure.

        Returns
        -------
        StepResult
            Mean force and moment, work, loss, and stored energy.

        Raises
        ------
        CaseError
            If the time is not after the current one, or an input is missing or not finite.
        StepError
            If the engine stopped, for instance because a particle left its cavity, or if the energies do not balance. The
            stepper cannot continue; an earlier state can be restored.
        KeyboardInterrupt
            After Ctrl-C during a long step; the stepper is then where the step began.
        """
        # A float is taken as it is: a step is short, and parsing a unit would take as long.
        length = float(to if isinstance(to, float) else in_si(to, "s")) - self.time
        if not 0 < length < np.inf:
            raise Hint(
                f"to = {to}: the time is {self.time:.6g} s; a step must end after it", f"to = {self.time + 1e-4:.6g}"
            )
        inputs = {"velocity": velocity, "acceleration": acceleration, "loads": loads}
        chosen = [name for name, value in inputs.items() if value is not None]
        allowed = ("velocity", "acceleration") if self._packed.alone else ("loads",)
        if len(chosen) != 1 or chosen[0] not in allowed:
            raise Hint(
                f"a step of this stepper needs {' or '.join(allowed)}, and is given {' and '.join(chosen) or 'nothing'}",
                f"advance(to, {allowed[0]}=...)",
            )
        values = self._inputs(chosen[0], inputs[chosen[0]])
        if velocity is None:
            self._core.advance(length, values)
        else:
            self._core.advance_to_velocity(length, values)
        self._check()
        return self._result()

    def displacement(self, point: str | None = None) -> Any:
        """Return the displacement at the end of the last step [m]: of a point, or of the attachment of a damper alone.

        Parameters
        ----------
        point
            Name of a point; None for the only one.

        Returns
        -------
        float or (3,) array
            Three components for particle dampers.
        """
        return self._motion(point, velocity=False)

    def velocity(self, point: str | None = None) -> Any:
        """Return the velocity at the end of the last step.

        Parameters
        ----------
        point
            As for `displacement`.

        Returns
        -------
        float or (3,) ndarray
            Velocity [m/s], with the components of `displacement`.
        """
        return self._motion(point, velocity=True)

    def save(self) -> bytes:
        """Return the state. A stepper that restores it continues with the same bits.

        Returns
        -------
        bytes
            State, for `restore` of a stepper of the same case.
        """
        return bytes(self._core.save())

    def restore(self, state: bytes) -> None:
        """Continue from a saved state of the same case.

        Parameters
        ----------
        state
            State from `save`.

        Raises
        ------
        CaseError
            If the state is damaged or belongs to another case; the stepper does not change then.
        """
        try:
            self._core.restore(state)
        except ValueError as error:
            raise CaseError(f"{error}", "a state that save() of a stepper of the same case returned") from None

    def _inputs(self, name: str, value: object) -> NDArray[np.float64]:
        unit = {"velocity": "m/s", "acceleration": "m/s^2"}.get(name)
        values = np.atleast_1d(np.asarray(value if unit is None else in_si(value, unit), dtype=np.float64))
        if values.shape != (len(self.inputs),):
            raise Hint(
                f"{name} has the shape {values.shape}; a step needs {len(self.inputs)}: {', '.join(self.inputs)}",
                f"{name} = {'0.1' if len(self.inputs) == 1 else [0.1] * len(self.inputs)}",
            )
        if not np.isfinite(values).all():
            raise Hint(f"{name} = {value}: inputs must be finite", "a shorter step, or another coupling")
        return np.ascontiguousarray(values)

    def _motion(self, point: str | None, *, velocity: bool) -> Any:
        if self._packed.alone:
            values = np.array(self._core.velocity if velocity else self._core.displacement)[: self._packed.axes]
        else:
            index = self.points.index(self._case.modes.point(point))
            values = self._core.outputs(velocity).reshape(-1, self._packed.axes)[index]
        return float(values[0]) if self._packed.axes == 1 else values

    def _result(self) -> StepResult:
        force: Any = self._core.force[:, 0] if self._packed.axes == 1 else self._core.force
        if self._packed.alone:
            force = float(force[0]) if self._packed.axes == 1 else force[0]
        elif stops := self._case.each_stop:  # the core returns how strongly each pushes
            force = np.concatenate([force[: -len(stops)], [-stop.sign for stop in stops] * force[-len(stops) :]])
        moment = self._core.moment[0] if len(self._core.moment) else np.zeros(3)  # a structure may have no damper
        return StepResult(force, moment, self._core.work, self._core.loss, self._core.stored)

    def _check(self) -> None:
        """Raise an error if the core has stopped."""
        if self._core.status != _core.Status.finished:
            raise StepError(
                f"the stepper stopped at t = {self.time:.6g} s ({self._core.status.name}). {self._reason()}"
            )

    def _reason(self) -> str:
        """Return the message of the status with which the core has stopped."""
        status, (damper, member, value) = self._core.status, self._core.stopped
        particles = self._case.particle_dampers
        if status == _core.Status.energy_error:
            shorter = "lower `fraction` of Dem, or give a larger `motion`" if particles else "lower the tolerance"
            return (
                f"The change of the stored energy differs from work - loss by {value:.2g} of the energy put in; the limit "
                f"is {_core.worst_energy_residual:g}. Do not use the results; {shorter}."
            )
        if damper < 0:
            where = ""
        elif particles:
            number = member + sum(each.contents.radius.size for each in particles[:damper])
            where = f"Particle {number}, in {particles[damper].label(damper)!r},"
        else:
            where = self._case.contact_names[first_contacts(self._case)[damper] + member]
        softened = damper >= 0 and bool(particles) and particles[damper].softening_factor > 1
        return describe(status, self.time, where, value, self._case.method.kind, softened=softened)[1]
