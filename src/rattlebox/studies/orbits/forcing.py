"""The common period of the loads of a case, and the refusal of cases that have none."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from rattlebox._util.quantities import amount
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.paths import get, place_of, replaced, spelt
from rattlebox.model.restitutions import Restitution

if TYPE_CHECKING:
    from rattlebox.model.case import Case

LARGEST_RATIO = 32
"""Largest numerator and denominator of a ratio of two frequencies with a common period."""
_SAME_RATIO = 1e-9
_WITHOUT_EFFECT = {"duration", "start", "velocity", "displacement", "tolerance", "stick"}
"""Fields of initial states and of the computation, on which a periodic motion does not depend."""


@dataclass(frozen=True)
class Forcing:
    """Harmonic loads and motions of a case with a common period.

    `cycles` are the numbers of their cycles in a period, by path.
    """

    case: Case
    cycles: Mapping[str, int]
    period: float  # [s]

    @classmethod
    def of(cls, case: Case, axes: Sequence[str] = ()) -> Forcing:
        """Return the forcing of a case; raise if its motion cannot be periodic or is not computed.

        A load without amplitude does not act, unless its amplitude is one of the parameters that vary.
        """
        if case.particle_dampers:
            raise Hint(
                "periodic motions are computed for impact dampers and stops, not for particle dampers, whose state has "
                "thousands of components",
                "rb.frequency_response or rb.damping_curve, or an ImpactDamper with one ball of the same mass",
                ["dampers"],
            )
        if not case.method.has_stepper:
            raise Hint(
                f"the method {case.method.kind} has fixed steps, so that its motion does not depend smoothly on the start",
                "method = rb.EventDriven(), or rb.Newton()",
                ["method"],
            )
        # Each load repeats, and acts from the start to the end.
        harmonics = case.harmonics
        groups = {"loads": case.loads, "base": case.base, "structure.motion": case.shaker_motion}
        for name, group in groups.items():
            for index, signal in enumerate(group):
                path = f"{name}[{index}]"
                if path not in harmonics:
                    what = "is random and never repeats" if signal.kind == "random" else "is a transient"
                    raise Hint(
                        f"{path}, a signal of kind {signal.kind!r}, {what}; all loads must be harmonic",
                        "a Harmonic in its place; or rb.simulate and rb.sweep for this load",
                        place_of(case, path),
                    )
        for path, signal in harmonics.items():
            if signal.start > 0 or signal.stop is not None:
                raise Hint(
                    f"{path} does not last; a periodic motion needs loads that act at all times",
                    "no start and no stop of the load",
                    place_of(case, path),
                )
        # A load without amplitude has no effect on the period.
        varied = [place_of(case, axis) for axis in axes]
        acting = {
            path: signal
            for path, signal in harmonics.items()
            if signal.amplitude != 0 or place_of(case, f"{path}.amplitude") in varied
        }
        if not acting:
            raise Hint(
                "the case has no load; a periodic motion repeats after whole cycles of a harmonic load or base motion",
                'load = rb.Harmonic(amplitude="1 N", frequency="50 Hz"); rb.damping_curve for free vibration',
                ["loads"],
            )
        cycles = _common_cycles(acting)
        first = next(iter(acting))
        return cls(case, cycles, cycles[first] / acting[first].frequency)

    def period_of(self, parameters: Sequence[str], values: Sequence[float]) -> tuple[float, list[float]]:
        """Return the period [s] at other values of parameters, and its derivatives with respect to them."""
        period, slopes = self.period, [0.0] * len(parameters)
        for index, (path, value) in enumerate(zip(parameters, values, strict=True)):
            if self.is_frequency(path):
                period = 1 / value
                slopes[index] = -1 / value**2
        return period, slopes

    def is_frequency(self, path: str) -> bool:
        """Return whether a path is the frequency of an acting load."""
        place = place_of(self.case, path)
        return any(place == place_of(self.case, f"{load}.frequency") for load in self.cycles)

    def check_parameter(self, path: str) -> None:
        """Raise if a path cannot be the parameter of a continuation."""
        place = place_of(self.case, path)
        if number_at(self.case, path) is None:
            raise Hint(
                f"{path} is not a number that can vary continuously",
                "the path of a number, such as load.frequency, load.amplitude or damper.gap",
            )
        if place[-1] == "phase":
            if len(self.cycles) == 1:
                raise Hint(f"{path} only shifts the time of the motion", "a frequency, an amplitude or a gap")
            # The map may begin at another phase, for which those of all loads are replaced (`shifted`).
            raise Hint(f"{path}, a phase of one of {len(self.cycles)} loads, cannot be followed", "rb.sweep over it")
        if self.is_frequency(path) and len(self.cycles) > 1:
            raise Hint(
                f"{path} is one of {len(self.cycles)} frequencies; if it varies alone, the loads have no common period",
                "an amplitude, or a case with one load",
            )
        if place[0] == "output" or _WITHOUT_EFFECT.intersection(map(str, place)):
            raise Hint(f"{spelt(self.case, place)} has no effect on a periodic motion", "a gap, a mass, or a load")

    def shifted(self, phase: float) -> Case:
        """Return the case whose time begins at a part of the period of the forcing."""
        if phase == 0:
            return self.case
        return replaced(
            self.case,
            {
                f"{path}.phase": self.case.harmonics[path].phase + 2 * math.pi * math.fmod(count * phase, 1.0)
                for path, count in self.cycles.items()
            },
        )


def number_at(case: Case, path: str) -> float | None:
    """Return the number at a path that can vary continuously, also in place of a law; None if there is none."""
    value = get(case, path)
    if isinstance(value, tuple) and len(value) == 1:
        (value,) = value
    if isinstance(value, Restitution):
        value = value.constant_value
    return float(value) if isinstance(value, float) and math.isfinite(value) else None


def _common_cycles(signals: Mapping[str, Harmonic]) -> dict[str, int]:
    """Return the numbers of cycles of the signals in their common period; raise if they have none."""
    (first, reference), *_ = signals.items()
    ratios = {}
    for path, signal in signals.items():
        quotient = signal.frequency / reference.frequency
        ratio = Fraction(quotient).limit_denominator(LARGEST_RATIO)
        if ratio.numerator > LARGEST_RATIO or abs(float(ratio) - quotient) > _SAME_RATIO * quotient:
            raise Hint(
                f"{first} at {amount(reference.frequency, 'Hz', 9)} and {path} at {amount(signal.frequency, 'Hz', 9)} have "
                f"no common period; the ratio of their frequencies must be one of whole numbers up to {LARGEST_RATIO}",
                "a ratio such as 1:2 or 2:3; rb.bifurcation and rb.lyapunov need no common period",
                place_of_frequency(path),
            )
        ratios[path] = ratio
    multiple = math.lcm(*(ratio.denominator for ratio in ratios.values()))
    counts = {path: int(ratio * multiple) for path, ratio in ratios.items()}
    divisor = math.gcd(*counts.values())
    return {path: count // divisor for path, count in counts.items()}


def place_of_frequency(path: str) -> tuple[str, ...]:
    """Return the place of the frequency of a signal for a message."""
    return (*path.split("."), "frequency")
