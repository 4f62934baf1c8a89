"""Cavities, particles and dampers for tests."""

from __future__ import annotations

from typing import Any

import rattlebox as rb

STEEL = rb.materials()["steel"]

CAVITIES = {
    "box": rb.Box(size=("40 mm", "30 mm", "60 mm")),
    "upright can": rb.Cylinder(diameter="40 mm", length="50 mm"),
    "lying can": rb.Cylinder(radius="20 mm", length="50 mm", axis="x"),
    "can askew": rb.Cylinder(radius="20 mm", length="50 mm", axis=(1, 2, -1)),
    "sphere": rb.SphericalCavity(radius="25 mm"),
}

SIZES = {
    "normal": rb.NormalSizes(mean="4 mm", deviation="0.5 mm", smallest="3 mm", largest="5 mm"),
    "log-normal": rb.LogNormal(median="4 mm", geometric_standard_deviation=1.2, smallest="3 mm", largest="6 mm"),
    "sieve": rb.Sieve(sizes=["2 mm", "3 mm", "5 mm"], passing=[0, 0.3, 1]),
}


def balls(count: int = 100, **options: Any) -> rb.Particles:
    """Return steel balls of 4 mm."""
    return rb.Particles(**{"material": "steel", "diameter": "4 mm", "count": count, **options})


def damper(**options: Any) -> rb.ParticleDamper:
    """Return a damper of a hundred steel balls in a cube."""
    usual = {
        "particles": balls(),
        "cavity": rb.Box(size=("40 mm",) * 3),
        "contact": rb.Tsuji(restitution=0.9),
        "friction": 0.3,
    }
    return rb.ParticleDamper(**{**usual, **options})


def case(*dampers: rb.ParticleDamper, **options: Any) -> rb.Case:
    """Return a case with one degree of freedom."""
    usual: dict[str, Any] = {"structure": rb.SDOF(mass=20, stiffness=8e4), "duration": 1.0}
    return rb.Case(**{**usual, "dampers": dampers or (damper(),), **options})
