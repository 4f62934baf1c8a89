"""Arguments of studies are looked at alike, whether they come from Python or from a file."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb


def shaken() -> rb.Case:
    """Return a ball in a shaken cavity."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="10 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            velocity=0.1,
            contact=rb.Tsuji(restitution=0.6),
        ),
        duration="1 s",
        method=rb.Newton(),
    )


WRONG = [
    *(("cycles", value) for value in [(-1, 2), (math.nan, 1), (1.5, 2), (1, 2, 3), (0, 0), (1,), (1, -5), "x", 5]),
    *(("samples", value) for value in [1, 0, -1, 2.5, math.nan, "x"]),
    *(("last", value) for value in [-1, 2.5, "x"]),
    *(("skip", value) for value in [-1, math.nan, "9 kg"]),
    *(("threads", value) for value in [0, -1, 1.5, "x"]),
]


@pytest.mark.parametrize(("name", "value"), WRONG, ids=str)
def test_arguments_are_refused_by_name(name: str, value: Any) -> None:
    """What no study file may hold is refused in Python, too, with the name and the value of the argument."""
    with pytest.raises(rb.CaseError, match="^" + re.escape(f"{name} = {value!r}\n")):
        rb.sweep(shaken(), {"damper.gap": ["1 mm"]}, ["peak"], **{name: value})


@pytest.mark.parametrize(
    ("study", "arguments"),
    [
        (rb.lyapunov, ()),
        (rb.loss_map, (["1 mm"], ["10 Hz"])),
        (rb.design, ({"damper.gap": ("1 mm", "2 mm")}, "peak")),
        (rb.sensitivity, ({"damper.gap": ("1 mm", "2 mm")}, "peak")),
    ],
    ids=["lyapunov", "loss_map", "design", "sensitivity"],
)
def test_ready_maps_refuse_the_same(study: Any, arguments: tuple[Any, ...]) -> None:
    """Ready maps look at their arguments as sweeps do."""
    for name, value in {"cycles": (-1, 2), "threads": 0}.items():
        with pytest.raises(rb.CaseError, match="^" + re.escape(f"{name} = {value!r}\n")):
            study(shaken(), *arguments, **{name: value})


def test_counts_of_numpy_are_counts(tmp_path: Path) -> None:
    """Counts may come from NumPy, also where a store keeps them."""
    counts = {"cycles": np.array([1, 2]), "samples": np.int64(5), "last": np.int32(2)}
    found = rb.sweep(shaken(), {"damper.gap": ["1 mm"]}, ["peak"], store=tmp_path / "s.zarr", **counts)
    assert (found.status == 0).all()


def test_one_measure_needs_no_list() -> None:
    """Ready maps take one measure by its name, as sweeps do; what is no measure is told so."""
    driven = rb.Case(
        structure=rb.SDOF(mass=1, stiffness=1e4, damping=2),
        damper=shaken().dampers[0],
        load=rb.Harmonic(amplitude="10 N", frequency="16 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )
    ways: dict[Any, Any] = {
        rb.bifurcation: ("load.amplitude", [5.0, 10.0]),
        rb.basins: ({"damper.start": [-1.0, 1.0]},),
        rb.frequency_response: ([15.0, 16.0],),
    }
    for study, arguments in ways.items():
        assert "peak" in study(driven, *arguments, cycles=(4, 2), measure="peak", progress=False)
        with pytest.raises(rb.CaseError, match="measure"):
            study(driven, *arguments, cycles=(4, 2), measure=5, progress=False)
    with pytest.raises(rb.CaseError, match="5 is neither the name of a measure"):
        rb.design(driven, {"damper.gap": ("1 mm", "2 mm")}, 5)
