"""Sizes and amounts of particles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.particle_dampers import SIZES, STEEL, balls, damper

import rattlebox as rb


@pytest.mark.parametrize("name", SIZES)
def test_total_mass(name: str) -> None:
    """The total mass is exact to within one particle, with sizes between the limits."""
    filled = damper(particles=rb.Particles(material="steel", distribution=SIZES[name], mass="60 g")).contents
    assert filled.mass.sum() == pytest.approx(0.06, abs=filled.mass.max())
    assert filled.mass == pytest.approx(4 / 3 * math.pi * filled.radius**3 * STEEL.density)
    assert filled.inertia == pytest.approx(0.4 * filled.mass * filled.radius**2)
    assert 1e-3 <= filled.radius.min() < filled.radius.max() <= 3e-3


WIDE = {
    "sieve": rb.Sieve(sizes=["0.2 mm", "1 mm", "10 mm"], passing=[0, 0.2, 1]),
    "sieve with a gap": rb.Sieve(sizes=["0.5 mm", "0.6 mm", "9.9 mm", "10 mm"], passing=[0, 0.5, 0.5, 1]),
    "log-normal": rb.LogNormal(median="1 mm", geometric_standard_deviation=2, smallest="0.01 mm", largest="50 mm"),
}


def test_a_sieve_accepts_percent() -> None:
    """The passing shares of a sieve may be in percent."""
    assert rb.Sieve(sizes=["2 mm", "3 mm", "5 mm"], passing=["0 %", "30 %", "100 %"]) == SIZES["sieve"]


@pytest.mark.parametrize("mass", [5e-3, 50e-3, 0.4])
@pytest.mark.parametrize("name", WIDE)
def test_the_mass_of_wide_distributions(name: str, mass: float) -> None:
    """The number of particles is the one with the mass closest to the requested mass or fill ratio."""
    kind = rb.Particles(material="steel", distribution=WIDE[name], mass=mass)
    number = kind.number(1.0)
    filled = [STEEL.density * math.pi / 6 * np.sum(kind.diameters(number + more) ** 3) for more in (-1, 0, 1)]
    assert np.abs(np.array(filled) - mass).argmin() == 1
    by_volume = rb.Particles(material="steel", distribution=WIDE[name], fill_ratio=mass / STEEL.density)
    assert by_volume.number(1.0) == number


def test_sieve_shares_are_shares_of_mass() -> None:
    """The mass share of the particles below a mesh is the passing share of the sieve table."""
    diameters = SIZES["sieve"].diameters((np.arange(100_000) + 0.5) / 100_000)
    assert np.sum(diameters[diameters < 3e-3] ** 3) / np.sum(diameters**3) == pytest.approx(0.3, abs=1e-3)


def test_normal_sizes_have_their_mean_and_deviation() -> None:
    """Distributions with wide limits have their mean and deviation, or median and geometric deviation."""
    share = (np.arange(100_000) + 0.5) / 100_000
    normal = rb.NormalSizes(mean=1e-2, deviation=1e-3, smallest=1e-3, largest=2e-2).diameters(share)
    assert (normal.mean(), normal.std()) == (pytest.approx(1e-2), pytest.approx(1e-3, rel=1e-3))
    wide = np.log(
        rb.LogNormal(median=1e-2, geometric_standard_deviation=1.3, smallest=1e-4, largest=1.0).diameters(share)
    )
    assert (np.exp(np.median(wide)), np.exp(wide.std())) == (pytest.approx(1e-2), pytest.approx(1.3, rel=1e-3))


def test_fill_ratio() -> None:
    """A fill ratio is the volume of the particles over that of the cavity."""
    contents = damper(particles=balls(count=None, fill_ratio=0.2)).contents
    assert np.sum(4 / 3 * math.pi * contents.radius**3) / 0.04**3 == pytest.approx(0.2, abs=1e-3)


def test_the_label_of_a_material_without_a_name() -> None:
    """The label of particles is their name or, if their material has no name, 'particles'."""
    stuff = rb.Material(density=2500, young=5e7, poisson=0.25)
    assert rb.Particles(material=stuff, radius="1 mm", count=1).label == "particles"
    assert rb.Particles(name="shot", material=stuff, radius="1 mm", count=1).label == "shot"


@pytest.mark.parametrize("count", [1, 2, 7])
def test_sizes_of_a_symmetric_distribution_are_symmetric(count: int) -> None:
    """The sizes of few particles from a symmetric distribution are symmetric: the middles of equal shares."""
    sizes = rb.NormalSizes(mean="4 mm", deviation="0.5 mm", smallest="2 mm", largest="6 mm")
    diameters = rb.Particles(material="steel", distribution=sizes, count=count).diameters(count)
    assert np.all(np.diff(diameters) > 0)
    assert diameters + diameters[::-1] == pytest.approx(np.full(count, 8e-3), rel=1e-12)


@pytest.mark.parametrize("size", ["diameter", "radius"])
@pytest.mark.parametrize("given", [WIDE["log-normal"], {"kind": "normal", "mean": "4 mm"}])
def test_a_distribution_is_no_diameter(size: str, given: object) -> None:
    """A distribution in the field of a length is refused with its own field; the message asked for a length before."""
    with pytest.raises(rb.CaseError, match=rf"{size}.*\n.*has its own field\n  try: distribution = "):
        rb.Particles(material="steel", count=9, **{size: given})


def test_a_count_of_absurd_size() -> None:
    """A count that no integer holds has a plain message, and not the one of the library that reads it."""
    with pytest.raises(rb.CaseError, match=r"count.*\n  an integer of usual size is needed"):
        rb.Particles(material="steel", count=1e300, diameter="4 mm")
