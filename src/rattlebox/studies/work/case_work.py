"""Fields and methods that the work of 1-D runs and of particle runs share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np

from rattlebox.core import _core
from rattlebox.model.errors import Hint
from rattlebox.model.harmonics import Harmonic
from rattlebox.model.random_vibration import Random
from rattlebox.studies.work.case_digest import describe_case
from rattlebox.studies.work.fingerprint import fingerprint
from rattlebox.studies.work.measures import INTERVAL, MEASURES, about, name_of
from rattlebox.studies.work.observed import Observed

if TYPE_CHECKING:
    from rattlebox.model.case import Case
    from rattlebox.results import Run
    from rattlebox.studies.grid.grid import Grid

Extra = tuple[tuple[str, int], ...]
"""Dimensions of an output beyond those of the grid, with their lengths."""

UserMeasure = Callable[["Run"], float]
_function_lock = Lock()  # functions of users need not be thread-safe


@dataclass
class CaseWork:
    """Variants of a case and measures of each.

    Attributes
    ----------
    skip
        Time from which measures are evaluated [s].
    """

    case: Case
    grid: Grid
    measures: Sequence[str | UserMeasure] = ()
    skip: float = 0.0
    cycles: tuple[int, int] | None = None
    samples: int | None = None
    point: str | None = None
    intervals: bool = False

    @property
    def size(self) -> int:
        """Number of variants."""
        return self.grid.size

    @property
    def measure_names(self) -> list[str]:
        """Measures that are given by name."""
        return [measure for measure in self.measures if isinstance(measure, str)]

    @property
    def functions(self) -> dict[str, UserMeasure]:
        """Measures that are functions of a Run, by name."""
        return {name_of(measure): measure for measure in self.measures if not isinstance(measure, str)}

    @property
    def averages(self) -> list[str]:
        """Measures with an interval: averages over a motion that is driven until the end of the run."""
        if not self.intervals or not _is_driven(self.case):
            return []
        return [name for name in self.measure_names if MEASURES[name].average]

    @cached_property
    def outputs(self) -> dict[str, tuple[Extra, str, dict[str, Any]]]:
        """Further dimensions, number type and attributes of each output."""
        statuses = " ".join(status.name for status in _core.Status)
        outputs: dict[str, tuple[Extra, str, dict[str, Any]]] = {
            "status": ((), "int8", {"long_name": "status of the run", "flag_meanings": statuses})
        }
        for name in self.measure_names:
            measure = MEASURES[name]
            attributes = {"units": self._units(name), "long_name": measure.long_name}
            outputs[name] = ((), "float64", attributes)
        for name in self.averages:
            attributes = {
                "units": self._units(name),
                "long_name": f"half of the 95 % interval, {MEASURES[name].long_name}",
            }
            outputs[name + INTERVAL] = ((), "float64", attributes)
        for name, function in self.functions.items():
            declared = about(function)
            outputs[name] = ((), "float64", {"units": declared.units, "long_name": declared.long_name})
        return outputs

    @property
    def _observed(self) -> Observed | None:
        """The observed motion, if it is named."""
        return None if self.point is None else Observed.of(self.case.modes, self.point)

    def units_of(self, units: str) -> str:
        """Return the unit of the observed motion for that of a point."""
        observed = self._observed
        return observed.units(units) if observed else units

    def _units(self, name: str) -> str:
        return self.units_of(MEASURES[name].units) if MEASURES[name].samples else MEASURES[name].units

    def require_interface_force(self) -> None:
        """Raise if the force on the base is requested and the participation of the modes is unknown."""
        asked = [name for name in self.measure_names if name.endswith("interface_force")]
        modes = self.case.modes
        if not asked:
            return
        if not modes.decay.size:
            raise Hint(f"{asked[0]} needs a structure that moves", "peak_damper_force, the force on the cavity")
        if modes.participation is None:
            raise Hint(f"{asked[0]} needs the participation of the modes", "participation = [...] of the structure")

    def describe(self) -> dict[str, Any]:
        """Return a description of everything except the grid, in JSON types."""
        functions = (f"{name} {fingerprint(function)}" for name, function in self.functions.items())
        return {
            **describe_case(self.case, self.grid.columns),
            "measures": [*self.measure_names, *functions],
            "cycles": None if self.cycles is None else list(self.cycles),
            **{name: getattr(self, name) for name in ("skip", "samples", "point")},
        }

    def call_functions(self, run: Run, index: int) -> dict[str, float]:
        """Return the values of the functions of a Run."""
        values = {}
        for name, function in self.functions.items():
            with _function_lock:
                value: Any = function(run)
            try:
                if isinstance(value, str) or np.ndim(value):
                    raise TypeError
                values[name] = float(value)
            except TypeError:
                kind = type(value).__name__
                raise Hint(
                    f"measure {name}: the function returned {kind} for variant {index}, not one number", "float(...)"
                ) from None
        return values


def _is_driven(case: Case) -> bool:
    """Return whether a harmonic or random load or motion acts until the end of every run."""
    signals = (*case.loads, *case.base, *case.shaker_motion)
    return any(isinstance(s, Random) or (isinstance(s, Harmonic) and s.stop is None) for s in signals)
