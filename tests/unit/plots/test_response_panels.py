"""Figures of responses over time."""

from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb

from .conftest import is_within_page

TOWER = rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=["60 MN/m"] * 3, damping_ratio="2 %")
CASE = rb.Case(
    structure=TOWER,
    base=rb.Harmonic(amplitude="0.1 g", frequency="2 Hz"),
    duration="1 s",
    output=rb.Output(rate="100 Hz"),
)


def test_default_panels_have_the_responses_that_are_not_zero() -> None:
    """A building on a moving base has panels of accelerations, drifts, and the force and acceleration of the base."""
    run = rb.simulate(CASE)
    figure = run.plot.responses()
    texts = [axes.get_ylabel().replace("\n", " ") for axes in figure.axes]
    assert texts == ["Absolute acceleration (m/s²)", "Drift (mm)", "Force on base (kN)", "Acceleration of base (m/s²)"]
    lines = figure.axes[1].lines[1:]
    assert [line.get_label() for line in lines] == ["storey 1 - base", "storey 2 - storey 1", "storey 3 - storey 2"]
    drift = rb.analysis.drift(run, "storey 2", "storey 1")
    np.testing.assert_allclose(lines[1].get_ydata(), 1e3 * drift, rtol=1e-12)


def test_particles_have_lines_along_three_axes(tmp_path: Path) -> None:
    """Forces of a 3-D run have three components; a named response has one panel in a window of time."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=8),
        cavity=rb.Box(size=("20 mm",) * 3),
        contact=rb.Tsuji(restitution=0.6),
        friction=0.2,
        packing=rb.Lattice(seed=1),
        point="storey 3",
        direction="x",
        softening=1000,
    )
    run = rb.simulate(rb.Case(structure=TOWER, base=CASE.base[0], damper=damper, duration=0.05))
    figure = run.plot.responses(of=["cavity_force", "modal_displacement"], between=(0.01, 0.04), size="page")
    force, modal = figure.axes
    assert [line.get_label() for line in force.lines[1:]] == ["along x", "along y", "along z"]
    assert len(modal.lines) == 4 and modal.get_ylabel().startswith("Displacement of modes")
    figure.savefig(tmp_path / "responses.png")


@pytest.mark.parametrize("size", ["column", "page", "slide"])
def test_many_storeys_are_chosen_and_the_choice_is_stated(size: str) -> None:
    """Of nine storeys the legend states that six are drawn; the figures of other tests have three storeys."""
    tower = rb.ShearBuilding(masses=["80 t"] * 9, stiffnesses=["90 MN/m"] * 9, damping_ratio="2 %")
    run = rb.simulate(CASE.replaced({"structure": tower}))
    figure = run.plot.responses(size=size)
    assert is_within_page(figure)
    titles = [legend.get_title().get_text() for axes in figure.axes if (legend := axes.get_legend())]
    assert titles == ["the largest 6 of 9"] * 2
    accelerations = ["acceleration", "absolute_acceleration", "base_acceleration"]
    assert is_within_page(run.plot.responses(of=accelerations, size=size))


@pytest.mark.parametrize(
    ("of", "message"),
    [
        ("peak", "absolute_acceleration"),
        ("storey 9 - storey 1", "storey 3"),
        ("cavity_force", "no force of damper"),
        ([], "empty"),
    ],
)
def test_unknown_responses(of: str, message: str) -> None:
    """The message names what the run has."""
    with pytest.raises(ValueError, match=message):
        rb.simulate(CASE).plot.responses(of=of)
