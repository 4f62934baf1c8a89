"""Functions of a run as measures: what tells one from another, and what they may be called."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.fingerprint import fingerprint

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
    """Return a measure that takes its limit from outside."""

    def share(run: Any) -> float:
        return float(np.mean(np.abs(run.motion.displacement) > limit))

    return share


def beyond(run: Any) -> float:
    """Return a share with a limit of the module."""
    return float(np.mean(np.abs(run.motion.displacement) > LIMIT))


class Above:
    """A measure that holds its limit."""

    def __init__(self, limit: float) -> None:
        self.limit = limit

    def __call__(self, run: Any) -> float:
        """Return a share."""
        return above(self.limit)(run)


def made(text: str) -> Callable[[Any], float]:
    """Return a function without a file, as at a prompt."""
    names: dict[str, Any] = {}
    exec(f"def typed(run):\n    return {text}", names)
    typed: Callable[[Any], float] = names["typed"]
    return typed


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (above(1e-3), above(1e-4)),
        (Above(1e-3), Above(1e-4)),
        (made("1.0"), made("2.0")),
        (partial(max, 1.0), partial(max, 2.0)),
        (partial(max, (1, 2, 1)), partial(max, (1, 2, 2))),
        (partial(above(1e-3)), partial(above(1e-4))),
        (above(np.arange(2000.0)), above(np.arange(2000.0) * 2)),  # type: ignore[arg-type]
    ],
)
def test_functions_differ_by_what_they_take_along(one: Any, other: Any) -> None:
    """A function is another one when what it takes from a closure, an object or a partial is, or its unwritten text."""
    assert fingerprint(one) == fingerprint(one) != fingerprint(other)


def test_equal_functions_are_one() -> None:
    """Functions that are made anew from equal values are the same, whichever objects hold these."""
    for make in (
        lambda: above(float("0.001")),
        lambda: Above(float("0.001")),
        lambda: partial(max, [1000, int("1000")]),
    ):
        assert fingerprint(make()) == fingerprint(make())


def test_functions_differ_by_their_modules_values(monkeypatch: pytest.MonkeyPatch) -> None:
    """A function is another one when a value of its module that it uses has changed."""
    before = fingerprint(beyond)
    monkeypatch.setitem(beyond.__globals__, "LIMIT", 1e-4)
    assert fingerprint(beyond) != before


def test_a_store_is_not_taken_for_that_of_another_function(tmp_path: Path) -> None:
    """A store goes on with the function that it was begun with, made anew, and refuses one that takes another limit."""
    first = rb.sweep(case(), AXES, above(1e-3), store=tmp_path / "a.zarr", workers=1)
    again = rb.sweep(case(), AXES, above(1e-3), store=tmp_path / "a.zarr", workers=1)
    np.testing.assert_array_equal(first.share, again.share)
    with pytest.raises(rb.StoreError, match="holds another study"):
        rb.sweep(case(), AXES, above(1e-4), store=tmp_path / "a.zarr", workers=1)


@pytest.mark.parametrize("name", ["status", "feasible", "added_mass"])
def test_names_of_other_parts_are_refused(name: str) -> None:
    """A function that is called like another part of a study is refused before anything runs."""
    measure = made("1.0")
    measure.__name__ = name
    with pytest.raises(rb.CaseError, match=f"{name} is the name of another variable"):
        rb.sweep(case(), AXES, measure)
    with pytest.raises(rb.CaseError, match=f"{name} is the name of another variable"):
        rb.design(case(), {"damper.gap": ("0.1 mm", "2 mm")}, [measure, "impact_share"], trials=1)


@pytest.mark.parametrize(
    ("name", "options"),
    [("impacts", {}), ("status", {}), ("instant", {"motion": True}), ("last", {"last": 2}), ("progress", {})],
)
def test_axes_are_not_called_like_outputs(name: str, options: Any) -> None:
    """An axis that is called like an output or an inner dimension is refused before anything runs."""
    with pytest.raises(rb.CaseError, match=f"{name} is the name of another variable"):
        rb.sweep(case(), {name: AXES}, "impacts", **options)
