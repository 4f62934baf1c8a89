"""A study with cheap, chaotic variants that take a chosen time; as a program, a study that tests can interrupt."""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox._util.owned_folder import read_marker
from rattlebox.studies.run.stored import progress_of
from rattlebox.studies.work.work import Work


@dataclass
class Grid:
    """Variants along two axes."""

    shape: tuple[int, ...] = (6, 10)
    dims: tuple[str, ...] = ("gap", "material")
    first: float = 3.6

    def coords(self) -> dict[str, Any]:
        """Return numbers with a unit, and names."""
        names = np.array([f"m{i}" for i in range(self.shape[1])])
        return {"gap": ("gap", np.linspace(0, 1, self.shape[0]), {"units": "m"}), "material": ("material", names)}

    def describe(self) -> dict[str, Any]:
        """Return the description that must agree to resume."""
        return {"shape": list(self.shape), "first": self.first}


@dataclass
class LogisticEngine:
    """Iterations of the logistic map, whose bits depend on the order of all operations."""

    grid: Grid = field(default_factory=Grid)
    pause: float = 0.0
    case: str = "[damper]\ngap = 0.1\n[load]\namplitude = 5.0\n"
    fail: bool = False
    crash: bool = False

    @property
    def block(self) -> int:
        """Preferred number of variants in a block."""
        return 7

    def coords(self) -> dict[str, Any]:
        """Return no coordinates of further dimensions."""
        return {}

    @property
    def outputs(self) -> dict[str, Any]:
        """Variables: a number, a status and a row of numbers."""
        names = "finished too_many_events"
        return {
            "value": ((), "float64", {"units": "J", "long_name": "value"}),
            "status": ((), "int8", {"long_name": "how the run ended", "flag_meanings": names}),
            "orbit": ((("step", 3),), "float32", {"units": "m", "long_name": "orbit"}),
        }

    def describe(self) -> dict[str, Any]:
        """Return the description that must agree to resume."""
        return {"case": self.case, "measure": ["value"]}

    def run(
        self, numbers: range, *, threads: int = 1, cancelled: Callable[[], bool] | None = None, reduction: None = None
    ) -> dict[str, NDArray[Any]] | None:
        """Compute a block after a pause for each of its variants."""
        until = time.perf_counter() + self.pause * len(numbers)
        while time.perf_counter() < until:
            if cancelled and cancelled():
                return None
            time.sleep(0.002)
        if self.fail:
            raise ZeroDivisionError("an error of the task")
        if self.crash and len(numbers) == math.prod(self.grid.shape):
            os._exit(1)
        number = np.array(numbers)
        size = math.prod(self.grid.shape)
        x = (number + 0.5) / size
        for _ in range(1000):
            x = (self.grid.first + 0.4 * number / size) * x * (1 - x)
        orbit = np.stack([x, x**2, x**3], axis=1).astype("f4")
        return {"value": x, "status": (number % 7 == 0).astype("i1"), "orbit": orbit}


class Logistic(Work):
    """A study of the logistic map."""

    def __init__(self, grid: Grid | None = None, **options: Any) -> None:
        super().__init__(LogisticEngine(grid or Grid(), **options))


def variants_in(store: Path) -> int:
    """Return the number of variants in a store, which may not exist yet."""
    return progress_of(store).done if is_complete(store) else 0


def is_complete(store: Path) -> bool:
    """Return whether a store has been created completely."""
    marker = read_marker(store)
    return marker is not None and marker.complete


if __name__ == "__main__":
    from rattlebox.studies.run.runner import run_work

    run_work(Logistic(pause=float(sys.argv[2])), store=sys.argv[1], block=5)
