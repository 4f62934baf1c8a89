"""Directional response of a tool at its cutting point, without dampers and with those of a map."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.analysis.describing_function import MassTable, solve
from rattlebox.analysis.signals import FloatArray
from rattlebox.model.modes import ModalModel

ComplexArray = NDArray[np.complex128]

_MODE_POINTS, _BASE_POINTS = 41, 400
"""Numbers of frequencies around each natural frequency, and over the whole range, from which sampling starts."""


def space_shape(model: ModalModel, name: str) -> FloatArray:
    """Return the mode shapes of a point, (m,): along the direction in which it moves most if it moves in 3-D."""
    shape = np.asarray(model.shapes[name])
    return shape if shape.ndim == 1 else shape[:, int(np.argmax((shape**2).sum(axis=0)))]


@dataclass(frozen=True, eq=False)
class Tool:
    """Structure without dampers, and the mode shapes of the cutting point along its direction, (m,)."""

    model: ModalModel
    point: str
    tip: FloatArray
    factor: float

    @classmethod
    def of(cls, model: ModalModel, point: str | None, direction: Any, factor: float) -> Tool:
        """Return the tool of a structure that cuts at a point along a direction."""
        name = model.point(point)
        return cls(model, name, np.asarray(model.shape(name, direction)), factor)

    def response(self, omega: FloatArray) -> ComplexArray:
        """Return the directional response at angular frequencies, (F,) [m/N]."""
        return np.asarray(self.factor * (self.model.harmonic_response(omega, self.tip[:, None])[:, :, 0] @ self.tip))

    def motion_ratio(self, omega: FloatArray, shapes: FloatArray) -> ComplexArray:
        """Return the displacement of points over that of the tip, under a force at the tip, (F, P)."""
        modal = self.model.harmonic_response(omega, self.tip[:, None])[:, :, 0]
        return np.asarray((modal @ shapes.T) / (modal @ self.tip)[:, None])

    def natural(self) -> FloatArray:
        """Return frequencies around the natural ones [Hz]."""
        parts = [np.zeros(0)]
        for squared, decay in zip(self.model.stiffness, self.model.decay, strict=True):
            if squared > 0:
                width = max(float(decay), 1e-6 * math.sqrt(squared))
                near = math.sqrt(squared) + width * np.tan(np.linspace(-1.5, 1.5, _MODE_POINTS))
                parts.append(near[near > 0] / (2 * math.pi))
        return np.concatenate(parts)

    def frequencies(self, passes: FloatArray) -> FloatArray:
        """Return the angular frequencies from which sampling starts; passes of teeth in a minute, (N,)."""
        own = np.sqrt(self.model.stiffness[self.model.stiffness > 0])
        low, high = 0.01 * own.min(), 4 * own.max()
        if passes.size:
            # The first lobe, of less than one wave, reaches up to the frequency of the teeth.
            rate = 2 * math.pi * passes / 60
            low, high = min(low, 0.01 * rate.min()), max(high, 1.01 * rate.max())
        return np.unique(np.concatenate([np.geomspace(low, high, _BASE_POINTS), 2 * math.pi * self.natural()]))


@dataclass(frozen=True, eq=False)
class LoadedTool:
    """Directional response of a tool whose tip vibrates with a given amplitude [m], with dampers at P points."""

    tool: Tool
    shapes: FloatArray
    table: MassTable
    number: int
    clearance: float
    amplitude: float

    @cached_property
    def _is_at_tip(self) -> bool:
        """Whether all dampers move like the tip, so that their amplitude is known."""
        return bool(np.all(self.shapes == self.tool.tip))

    def motions(self, omega: FloatArray) -> ComplexArray:
        """Return the accelerations of the dampers, (F, S, P); NaN outside of the map."""
        hertz = omega / (2 * math.pi)
        if self._is_at_tip:
            size = self.amplitude * (omega**2 if self.table.is_acceleration else np.ones_like(omega))
            inside = self.table.covers(hertz) & (size >= self.table.amplitude[0] * (1 - 1e-9))
            inside &= size <= self.table.amplitude[-1] * (1 + 1e-9)
            moved = np.where(inside, -(omega**2) * self.amplitude, np.nan).astype(complex)
            return np.repeat(moved[:, None, None], len(self.shapes), axis=2)
        # The motion of the tip is prescribed: the dampers are on a structure that is held there, and driven by it.
        tip, damper, across = self._receptances(omega)
        squared = -(omega**2)[:, None]
        drive = squared * across / tip[:, None]
        gain = squared[:, :, None] * (damper - across[:, :, None] * across[:, None, :] / tip[:, None, None])
        found = solve(self.table, hertz, self.number * gain, drive, np.array([self.amplitude]))
        moved = found.acceleration[0]
        lost = (found.is_below | found.is_above | found.is_lost)[0]
        return np.where(lost[:, None, None], np.nan, moved)

    def _receptances(self, omega: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Return the displacements per force: tip on tip, (F,), dampers on dampers, (F, P, P), and on the tip, (F, P)."""
        forces = np.column_stack([self.tool.tip, self.shapes.T])
        modal = self.tool.model.harmonic_response(omega, forces)
        return modal[:, :, 0] @ self.tool.tip, self.shapes @ modal[:, :, 1:], modal[:, :, 0] @ self.shapes.T

    def __call__(self, omega: FloatArray) -> ComplexArray:
        """Return the directional response, (F,) [m/N]: of all motions that with the smallest real part."""
        moved = self.motions(omega)
        tip, _, across = self._receptances(omega)
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log(np.abs(moved)) - self.table.log_acceleration(omega)[:, None, None]
            mass, _ = self.table.curves(omega / (2 * math.pi), store=False).evaluate(
                np.arange(omega.size), np.nan_to_num(logs, nan=self.table.limits[0])
            )
            reaction = np.einsum("fsp,fp->fs", -self.number * mass * moved, across)
            force = (self.amplitude - reaction) / tip[:, None]
            alone = np.where(self.can_rest(omega), tip, np.nan)
            responses = self.tool.factor * np.column_stack([self.amplitude / force, alone])
        worst = np.where(np.isfinite(responses), responses.real, np.inf).argmin(axis=1)
        return np.asarray(responses[np.arange(omega.size), worst])

    def can_rest(self, omega: FloatArray) -> NDArray[np.bool_]:
        """Return whether balls that no wall reaches may stay at rest, a motion that no map contains, (F,)."""
        tip, _, across = self._receptances(omega)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = 2 * self.amplitude * np.abs(across / tip[:, None]).max(axis=1)
        return np.asarray((reach < self.clearance) & self.table.covers(omega / (2 * math.pi)))

    def amplitudes_of_tip(self, omega: float) -> FloatArray:
        """Return the amplitudes of the tip that belong to those of the table at an angular frequency [m]."""
        ratio = np.abs(self.tool.motion_ratio(np.array([omega]), self.shapes)).max()
        squared = omega**2 if self.table.is_acceleration else 1.0
        return np.asarray(self.table.amplitude / (ratio * squared))
