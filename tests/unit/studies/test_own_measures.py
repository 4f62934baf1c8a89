"""Functions of a run as measures: fingerprints and names."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.studies.study_file import read_study
from rattlebox.studies.work.variants import fingerprint

LIMIT = 1e-3
AXES = {"damper.gap": ["0.4 mm", "0.8 mm"]}


def case() -> rb.Case:
    """Return an impact damper under a pulse."""
    return rb.Case(
        structure=rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m"),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="30 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.HalfSine(amplitude="5 kN", duration="1 ms"),
        duration="0.3 s",
    )


def above(limit: float) -> Callable[[Any], float]:
    """Return a measure with its limit in a closure."""

    def share(run: Any) -> float:
        return float(np.mean(np.abs(run.motion.displacement) > limit))

    return share


def beyond(run: Any) -> float:
    """Return a share with a limit that is a module variable."""
    return float(np.mean(np.abs(run.motion.displacement) > LIMIT))


class Above:
    """Measure with its limit as attribute."""

    def __init__(self, limit: float) -> None:
        self.limit = limit

    def __call__(self, run: Any) -> float:
        """Return the share of samples above the limit."""
        return above(self.limit)(run)


def typed_function(text: str) -> Callable[[Any], float]:
    """Return a function without source file, as typed at a prompt."""
    names: dict[str, Any] = {}
    exec(f"def typed(run):\n    return {text}", names)
    typed: Callable[[Any], float] = names["typed"]
    return typed


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (above(1e-3), above(1e-4)),
        (Above(1e-3), Above(1e-4)),
        (typed_function("1.0"), typed_function("2.0")),
        (partial(max, 1.0), partial(max, 2.0)),
        (partial(max, (1, 2, 1)), partial(max, (1, 2, 2))),
        (partial(above(1e-3)), partial(above(1e-4))),
        (above(np.arange(2000.0)), above(np.arange(2000.0) * 2)),  # type: ignore[arg-type]
    ],
)
def test_fingerprints_depend_on_closures_and_attributes(one: Any, other: Any) -> None:
    """The fingerprint of a function depends on its closure, attributes, partial arguments and code."""
    assert fingerprint(one) == fingerprint(one) != fingerprint(other)


def test_equal_functions_have_one_fingerprint() -> None:
    """Functions created twice from equal values have the same fingerprint."""
    for make in (
        lambda: above(float("0.001")),
        lambda: Above(float("0.001")),
        lambda: partial(max, [1000, int("1000")]),
    ):
        assert fingerprint(make()) == fingerprint(make())


def test_fingerprints_depend_on_module_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fingerprint depends on the values of the module variables that the function uses."""
    before = fingerprint(beyond)
    monkeypatch.setitem(beyond.__globals__, "LIMIT", 1e-4)
    assert fingerprint(beyond) != before


def test_a_store_refuses_another_function(tmp_path: Path) -> None:
    """A store accepts an equal function in a later call and refuses one with another limit."""
    first = rb.sweep(case(), AXES, above(1e-3), store=tmp_path / "a.zarr", workers=1)
    again = rb.sweep(case(), AXES, above(1e-3), store=tmp_path / "a.zarr", workers=1)
    np.testing.assert_array_equal(first.share, again.share)
    with pytest.raises(rb.StoreError, match="holds another study"):
        rb.sweep(case(), AXES, above(1e-4), store=tmp_path / "a.zarr", workers=1)


@pytest.mark.parametrize("name", ["status", "feasible", "added_mass"])
def test_names_of_other_variables_are_refused(name: str) -> None:
    """A function with the name of another variable is refused before the first run."""
    measure = typed_function("1.0")
    measure.__name__ = name
    with pytest.raises(rb.CaseError, match=f"{name} is the name of another variable"):
        rb.sweep(case(), AXES, measure)
    with pytest.raises(rb.CaseError, match=f"{name} is the name of another variable"):
        rb.design(case(), {"damper.gap": ("0.1 mm", "2 mm")}, [measure, "impact_share"], trials=1)


@pytest.mark.parametrize(
    ("name", "options"),
    [("impacts", {}), ("status", {}), ("instant", {"motion": True}), ("last", {"last": 2}), ("progress", {})],
)
def test_axes_with_names_of_outputs_are_refused(name: str, options: Any) -> None:
    """An axis with the name of an output or an inner dimension is refused before the first run."""
    with pytest.raises(rb.CaseError, match=f"{name} is the name of another variable"):
        rb.sweep(case(), {name: AXES}, "impacts", **options)


@pytest.mark.parametrize("form", ['"equivalent_damping"', '["peak", "equivalent_damping"]'])
def test_study_files_name_the_equivalent_damping(tmp_path: Path, form: str) -> None:
    """A sweep of a study file computes the damping ratio of a free decay by the name of the function."""
    (tmp_path / "study.toml").write_text(
        f'kind = "sweep"\nmeasure = {form}\n[axes]\n"structure.damping_ratio" = [0.01, 0.02, 0.04]\n'
        '[case]\nduration = "2 s"\n[case.structure]\n'
        'kind = "sdof"\nmass = "3 kg"\nfrequency = "20 Hz"\ndamping_ratio = 0.02\nvelocity = "0.3 m/s"\n'
    )
    result = read_study(tmp_path / "study.toml").run()
    ratios = np.array([0.01, 0.02, 0.04])
    assert (np.abs(result.equivalent_damping / ratios - 1) < 1.5 * ratios).all()  # the energy falls in steps


@pytest.mark.parametrize("output", [{}, {"output": rb.Output(rate=2000)}, {"output": rb.Output(times=[0.01, 0.1])}])
def test_a_function_costs_no_second_simulation(monkeypatch: pytest.MonkeyPatch, output: Any) -> None:
    """A variant with a function of its Run is simulated once, with the bits of both a sweep and `rb.simulate`.

    Each variant once ran twice, in the core and by `rb.simulate`; no test counted the runs.
    """
    base = case().model_copy(update=output)
    alone = rb.sweep(base, AXES, ["peak", "impact_share", "peak_overlap"], progress=False)
    runs = [rb.simulate(base.replaced({"damper.gap": gap})) for gap in AXES["damper.gap"]]
    seen: list[rb.Run] = []

    def largest_overlap(run: rb.Run) -> float:
        seen.append(run)
        return float(run.impacts.peak_overlap.max())

    swept, simulated = [], []
    sweep = _core.sweep
    monkeypatch.setattr(_core, "sweep", lambda *args, **options: (swept.append(args[2:4]), sweep(*args, **options))[1])
    monkeypatch.setattr(_core, "simulate", lambda *args, **options: simulated.append(args))
    both = rb.sweep(base, AXES, ["peak", "impact_share", "peak_overlap", largest_overlap], progress=False, workers=1)
    assert swept == [(0, 1), (1, 2)] and not simulated
    for name in alone.data_vars:
        np.testing.assert_array_equal(both[name], alone[name])
    np.testing.assert_array_equal(both.largest_overlap, [run.impacts.peak_overlap.max() for run in runs])
    for run, expected in zip(seen, runs, strict=True):
        assert run.case == expected.case and run.counts == expected.counts and run.notes == expected.notes
        for name in ("time", "displacement", "viscous_loss", "cavity_force"):
            np.testing.assert_array_equal(getattr(run.arrays, name), getattr(expected.arrays, name))


def test_functions_get_the_run_of_the_cycles() -> None:
    """With cycles a function of a 1-D run gets the run whose cycles are evaluated, as one of a particle run does.

    It once got a run of the duration of the case; no test had looked at the run.
    """
    driven = case().model_copy(update={"loads": (rb.Harmonic(amplitude="50 N", frequency="10 Hz"),)})

    def end(run: rb.Run) -> float:
        return float(run.arrays.time[-1])

    axes = {"load.frequency": ["8 Hz", "10 Hz"]}
    result = rb.sweep(driven, axes, ["rms", end], cycles=(3, 5), progress=False)
    np.testing.assert_allclose(result.end, [8 / 8, 8 / 10], rtol=1e-15)
