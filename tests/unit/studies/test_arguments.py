"""Validation of the arguments of studies, the same for Python and study files."""

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
    *(("workers", value) for value in [0, -1, 1.5, "x"]),
]


@pytest.mark.parametrize(("name", "value"), WRONG, ids=str)
def test_arguments_are_refused_by_name(name: str, value: Any) -> None:
    """Bad arguments of a sweep are refused with the name and the value."""
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
def test_other_studies_refuse_the_same(study: Any, arguments: tuple[Any, ...]) -> None:
    """Other studies check the common arguments as sweeps do."""
    for name, value in {"cycles": (-1, 2), "workers": 0}.items():
        with pytest.raises(rb.CaseError, match="^" + re.escape(f"{name} = {value!r}\n")):
            study(shaken(), *arguments, **{name: value})


def driven() -> rb.Case:
    """Return a ball in a structure under a harmonic load."""
    return rb.Case(
        structure=rb.SDOF(mass=1, stiffness=1e4, damping=2),
        damper=shaken().dampers[0],
        load=rb.Harmonic(amplitude="10 N", frequency="16 Hz"),
        duration="1 s",
        method=rb.Newton(),
    )


GAP: dict[str, Any] = {"damper.gap": ("1 mm", "2 mm")}
OWN: list[tuple[Any, tuple[Any, ...], str, Any]] = [
    *((rb.frequency_response, ([15.0, 16.0],), "tolerance", value) for value in ["x", -1, True, 1]),
    *((rb.bifurcation, ("load.amplitude", [5.0, 10.0]), "tolerance", value) for value in [0, None]),
    (rb.basins, ({"damper.start": [-1.0, 1.0]},), "apart", "x"),
    *((rb.lyapunov, (), name, value) for name, value in [("distance", 1), ("distance", True), ("reach", -1)]),
    *((rb.lyapunov, (), name, value) for name, value in [("seed", -1), ("steps", 0), ("pairs", 2.5), ("pairs", 0)]),
    *((rb.design, (GAP, "peak"), "max_added_mass", value) for value in [-1, "1 m"]),
    *((rb.design, (GAP, "peak"), "robust", value) for value in [["worst"], "best"]),
    *((rb.design, (GAP, "peak"), name, value) for name, value in [("trials", True), ("seed", 0.5)]),
    *((rb.sensitivity, (GAP, "peak"), "confidence", value) for value in [None, 1]),
    (rb.sensitivity, (GAP, "peak"), "n", 7),
]


@pytest.mark.parametrize(
    ("study", "arguments", "name", "value"), OWN, ids=[f"{row[0].__name__}-{row[2]}-{row[3]}" for row in OWN]
)
def test_each_study_refuses_its_own_by_name(study: Any, arguments: tuple[Any, ...], name: str, value: Any) -> None:
    """Bad arguments of one kind of study are refused with the name and the value."""
    with pytest.raises(rb.CaseError, match="^" + re.escape(f"{name} = {value!r}\n")):
        study(driven(), *arguments, cycles=(4, 2), **{name: value})


@pytest.mark.parametrize(
    ("study", "arguments"),
    [
        (rb.sweep, ({"damper.gap": ["1 mm"]}, ["peak"])),
        (rb.lyapunov, ()),
        (rb.design, (GAP, "peak")),
        (rb.sensitivity, (GAP, "peak")),
    ],
    ids=["sweep", "lyapunov", "design", "sensitivity"],
)
def test_skip_and_cycles_exclude_each_other(study: Any, arguments: tuple[Any, ...]) -> None:
    """`skip` together with `cycles` is refused, not ignored."""
    with pytest.raises(rb.CaseError, match=r"skip = 0\.1 s and cycles exclude each other"):
        study(driven(), *arguments, cycles=(4, 2), skip="0.1 s")


def test_bad_types_of_parameters_are_refused() -> None:
    """A path or bounds of a wrong type raise a CaseError."""
    for path in (3, [["load.amplitude"]], ["load.amplitude"]):
        with pytest.raises(rb.CaseError):
            rb.bifurcation(driven(), path, [5.0, 10.0], cycles=(4, 2))
    for bounds in (None, {}, [1]):
        with pytest.raises(rb.CaseError, match=r"bounds.*\n?.*mapping of paths to bounds or choices"):
            rb.sensitivity(driven(), bounds, "peak", 8)  # type: ignore[arg-type]


def test_counts_of_numpy_are_counts(tmp_path: Path) -> None:
    """Counts may be NumPy integers, also with a store."""
    counts = {"cycles": np.array([1, 2]), "samples": np.int64(5), "last": np.int32(2)}
    result = rb.sweep(shaken(), {"damper.gap": ["1 mm"]}, ["peak"], store=tmp_path / "s.zarr", **counts)
    assert (result.status == 0).all()


def test_one_measure_needs_no_list() -> None:
    """All studies accept the name of a single measure and refuse other values."""
    ways: dict[Any, Any] = {
        rb.bifurcation: ("load.amplitude", [5.0, 10.0]),
        rb.basins: ({"damper.start": [-1.0, 1.0]},),
        rb.frequency_response: ([15.0, 16.0],),
    }
    for study, arguments in ways.items():
        assert "peak" in study(driven(), *arguments, cycles=(4, 2), measure="peak", progress=False)
        with pytest.raises(rb.CaseError, match="measure"):
            study(driven(), *arguments, cycles=(4, 2), measure=5, progress=False)
    with pytest.raises(rb.CaseError, match="5 is not the name of a measure"):
        rb.design(driven(), {"damper.gap": ("1 mm", "2 mm")}, 5)
