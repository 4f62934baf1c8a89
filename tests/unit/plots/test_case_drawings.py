"""Drawings of cases: each kind of structure and damper, dimensions, names, and what is left out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

import rattlebox as rb
from rattlebox._util.quantities import amount

from .conftest import is_within_page

BALL = rb.ImpactDamper(
    ball=rb.Sphere(diameter="20 mm", material="steel"), gap="2 mm", contact=rb.Tsuji(restitution=0.6)
)
FORCE = rb.Harmonic(amplitude="10 N", frequency="30 Hz")


def texts(figure: Figure) -> str:
    """Return all texts of a figure."""
    found = [each.get_text() for each in figure.findobj(Text) if isinstance(each, Text) and each.get_visible()]
    return "\n".join(found).replace("\N{NO-BREAK SPACE}", " ")


def damper(cavity: Any = None, **changes: Any) -> rb.ParticleDamper:
    """Return a particle damper of a few balls."""
    parts: dict[str, Any] = {
        "particles": rb.Particles(material="glass", diameter="4 mm", count=20),
        "cavity": cavity or rb.Box(size=("20 mm", "16 mm", "12 mm")),
        "contact": rb.Tsuji(restitution=0.8),
        "friction": 0.2,
        "packing": rb.Settled(seed=1),
    }
    return rb.ParticleDamper(**(parts | changes))


def beam(ends: str = "clamped-free", **changes: Any) -> rb.Beam:
    """Return a steel beam."""
    return rb.Beam(length="0.2 m", ends=ends, material="steel", damping_ratio=0.01, **({"diameter": "20 mm"} | changes))


def on(structure: Any, *dampers: Any, **changes: Any) -> rb.Case:
    """Return a case."""
    return rb.Case(structure=structure, dampers=dampers, duration="1 s", **changes)


SDOF = rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping="25.3 N s/m")
CASES: dict[str, tuple[rb.Case, tuple[str, ...]]] = {
    "oscillator": (
        on(SDOF, BALL, loads=FORCE),
        ("20 kg", "80 kN/m", "25.3 N s/m", "F(t)", "24 mm", "2 mm", "not to scale"),
    ),
    "small gap": (on(SDOF, BALL.model_copy(update={"gap": 1e-4})), ("gap 0.1 mm, x", "enlarged")),
    "free mass": (on(rb.SDOF(mass="1 kg", stiffness=0), BALL), ("1 kg",)),
    "tuned mass": (
        on(SDOF, tuned_masses=rb.TunedMass(mass="1 kg", frequency="9.5 Hz"), base=rb.Random("gevs_acceptance", "1 s")),
        ("1 kg, 9.5 Hz", "motion of the base"),
    ),
    "row": (
        on(
            SDOF,
            rb.ImpactDamper(
                balls=[rb.Sphere(radius=r, material=m) for r, m in ((5e-3, "steel"), (4e-3, "glass"))],
                gap="1 mm",
                contact=rb.Tsuji(restitution=0.6),
            ),
        ),
        ("2 steel and glass balls", "diameter 10 mm and 8 mm"),
    ),
    "cantilever": (
        on(
            beam(tip_mass="50 g", points={"cavity": "0.15 m"}),
            BALL.model_copy(update={"point": "tip"}),
            BALL.model_copy(update={"point": "cavity", "name": "inner"}),
            loads=FORCE.model_copy(update={"point": "tip"}),
        ),
        ("200 mm", "50 g", "cavity", "tip", "damper and inner", "section"),
    ),
    "pinned beam": (
        on(
            beam("pinned-pinned", diameter=None, width="10 mm", height="5 mm"),
            BALL.model_copy(update={"point": "middle"}),
        ),
        ("10 mm x 5 mm", "middle"),
    ),
    "free beam": (on(beam("free-free", inner_diameter="10 mm")), ("inner 10 mm",)),
    "plate": (
        on(
            rb.Plate(
                length="0.6 m", width="0.4 m", thickness="3 mm", material="aluminium", points={"a": ("0.1 m", "0.1 m")}
            ),
            damper(rb.Cylinder(diameter="16 mm", length="12 mm"), point="a", direction="z"),
            loads=FORCE.model_copy(update={"point": "middle"}),
        ),
        ("600 mm", "400 mm", "3 mm thick", "cylinder, 16 mm in diameter, 12 mm long", "20 glass balls of 4 mm"),
    ),
    "building": (
        on(
            rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=["60 MN/m"] * 3),
            BALL.model_copy(update={"point": "storey 3"}),
            base=rb.Harmonic(amplitude="1 m/s^2", frequency="1 Hz"),
        ),
        ("50 t", "60 MN/m", "motion of the base", "1 m/s²"),
    ),
    "modes": (
        on(
            rb.Modal(frequencies=[8, 23], damping_ratio=0.01, shapes={"tip": [0.5, 0.3], "root": [0.1, 0.2]}),
            BALL.model_copy(update={"point": "tip"}),
            loads=FORCE.model_copy(update={"point": "root"}),
        ),
        ("at tip", "at root", "Natural frequency"),
    ),
    "shaker": (
        on(
            rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="20 Hz")),
            damper(rb.SphericalCavity(diameter="20 mm")),
        ),
        ("shaker", "sphere, 20 mm in diameter", "a harmonic displacement of 1 mm at 20 Hz"),
    ),
    "inclined cylinder": (
        on(rb.Fixed(), damper(rb.Cylinder(diameter="16 mm", length="20 mm", axis=(1, 0, 1)))),
        ("fixed", "cylinder, 16 mm in diameter, 20 mm long"),
    ),
    "end of a cylinder": (on(rb.Fixed(), damper(rb.Cylinder(diameter="16 mm", length="20 mm", axis="y"))), ("16 mm",)),
    "many particles": (
        on(rb.Fixed(), damper(particles=rb.Particles(material="glass", diameter="0.5 mm", fill_ratio=0.4))),
        ("glass balls of 0.5 mm", "% of the volume"),
    ),
    "four dampers": (
        on(
            beam(),
            *(
                BALL.model_copy(update={"gap": gap, "point": "tip", "name": f"d{gap}"})
                for gap in (1e-3, 2e-3, 3e-3, 4e-3)
            ),
        ),
        ("(1) d0.001", "(3) d0.003", "1 further dampers are not drawn"),
    ),
    "nothing": (on(SDOF), ("20 kg",)),
}


@pytest.mark.parametrize(
    ("name", "size"), [*((name, "page") for name in CASES), ("cantilever", "column"), ("small gap", "slide")]
)
def test_cases_are_drawn_with_their_dimensions(name: str, size: rb.plots.style.Size) -> None:
    """Each kind of structure and damper is drawn within the page, with its dimensions and numbers."""
    case, words = CASES[name]
    figure = rb.plot_case(case, size=size)
    assert is_within_page(figure)
    for each in words:
        assert each in texts(figure), each


def test_equal_dampers_are_drawn_once() -> None:
    """Dampers that differ in point, name, start and seed only share a panel; others have their own."""
    tip = damper(point="tip", direction="z")
    again = tip.model_copy(update={"name": "second", "packing": rb.Settled(seed=2)})
    other = tip.model_copy(update={"name": "third", "friction": rb.Mindlin(coefficient=0.5)})
    assert len(rb.plot_case(on(beam(), tip, again)).axes) == 2
    assert len([axes for axes in rb.plot_case(on(beam(), tip, again, other)).axes if axes.get_title(loc="left")]) == 2


@pytest.mark.parametrize("size", ["page", "column"])
def test_cells_share_a_mark_and_titles_are_on_the_page(size: rb.plots.style.Size) -> None:
    """Seven cells at the tip of a beam: one mark without a number, and a title that the first layout cut off."""
    cells = [["0 mm", 0, 0], *([f"{23 * i} mm", 0, f"{12 * k} mm"] for i in (-1, 1) for k in (-2, 0, 2))]
    beam = rb.Beam(length="160 mm", material="aluminium", width="40 mm", height="12 mm", tip_mass="0.4 kg")
    box = damper(rb.Box(size=("20 mm", "20 mm", "22 mm")), point="tip", offsets=cells)
    figure = rb.plot_case(
        rb.Case(structure=beam, damper=box, load=FORCE.model_copy(update={"point": "tip"}), duration=1), size=size
    )
    assert is_within_page(figure)
    assert "7 cells, in each:" in texts(figure) and "\n1\n" not in texts(figure)


def test_rotation_is_stated() -> None:
    """A cavity that turns says so; its drawing looked like one at rest, and another speed is another damper."""
    holes = [
        damper(rotation=rb.Rotation(speed=speed, axis="y", arm=("60 mm", 0, 0), angle=angle))
        for speed, angle in (("300 rpm", 0), ("300 rpm", "90 deg"), ("450 rpm", 0))
    ]
    rocking = damper(rotation=rb.Rotation(amplitude="5 deg", frequency="2 Hz", arm=(0, 0, 0)))
    drawn = texts(rb.plot_case(rb.Case(structure=rb.SDOF(mass=1, frequency=50), dampers=[*holes, rocking], duration=1)))
    for words in ("turns at 300 rpm about y", "turns at 450 rpm about y", "rocks by 5 deg at 2 Hz about z"):
        assert drawn.count(words) == 1


def test_names_are_not_read_as_mathematics() -> None:
    """Dollar signs and braces in names are drawn as they are."""
    odd = "$\\frac{$ {x} 100 %"
    structure = rb.Modal(frequencies=[8], damping_ratio=0.01, shapes={odd: [0.5]})
    figure = rb.plot_case(on(structure, BALL.model_copy(update={"name": odd})))
    figure.draw_without_rendering()
    assert odd[:10] in texts(figure)


def test_balls_and_gap_are_to_scale() -> None:
    """The ball of 20 mm and its cavity of 24 mm have these sizes in one scale of both axes."""
    figure = rb.plot_case(on(SDOF, BALL))
    panel = figure.axes[1]
    assert panel.get_aspect() == 1
    circles = [patch for patch in panel.patches if type(patch).__name__ == "Circle"]
    assert circles[0].get_radius() == pytest.approx(10e-3)  # type: ignore[attr-defined]
    walls = [patch.get_extents().transformed(panel.transData.inverted()) for patch in panel.patches[:2]]
    assert walls[1].x0 - walls[0].x1 == pytest.approx(24e-3, rel=1e-9)


def test_run_draws_its_case(tmp_path: Path) -> None:
    """A run draws the case that it has run."""
    run = rb.simulate(on(SDOF, BALL, loads=FORCE).model_copy(update={"duration": 0.05}))
    assert "case" in dir(run.plot)
    assert "20 kg" in texts(run.plot.case())


def test_other_objects_are_refused() -> None:
    """An object that is not a case is refused."""
    with pytest.raises(TypeError, match="a case is needed"):
        rb.plot_case("case.toml")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("cavity", "body", "lines"),
    [
        (rb.Box(size=("30 mm", "24 mm", "20 mm")), rb.RodBody(diameter="6 mm", length="80 mm", axis="x"), 2),
        (
            rb.Cylinder(diameter="40 mm", length="20 mm", axis="y"),
            rb.Honeycomb(cell="12 mm", thickness="1 mm", rings=3, axis="y"),
            9,
        ),
        (rb.Cylinder(diameter="36 mm", length="24 mm", axis="x"), rb.BodyCross(count=3, thickness="2 mm", axis="x"), 0),
        (rb.SphericalCavity(diameter="36 mm"), rb.RodBody(diameter="8 mm", axis="y", position=("3 mm", 0, 0)), 1),
        (rb.SphericalCavity(diameter="36 mm"), rb.PlateBody(size=("50 mm", "50 mm", "2 mm")), 2),
        (rb.Box(size=("30 mm", "24 mm", "20 mm")), rb.BallBody(diameter="8 mm", position=("14 mm", 0, 0)), 1),
    ],
    ids=["rod", "honeycomb", "cross", "end of a rod", "plate", "ball"],
)
def test_bodies_are_drawn_in_their_cavity_only(cavity: Any, body: Any, lines: int) -> None:
    """Bodies that reach through the wall were drawn outside, with their dimensions; those of the tests were inside."""
    particles = rb.Particles(material="glass", diameter="2 mm", count=5)
    lattice = damper(cavity, bodies=[body], particles=particles, packing=rb.Settled(seed=1))
    view = np.eye(3)[[0, 2, 1]] * [[1], [1], [-1]]
    alone = cavity.outline(view)
    drawn = lattice.interior.outline(view)[len(alone) :]
    assert len(drawn) >= lines
    limits = np.concatenate(alone) @ view[:2].T
    for line in drawn:
        seen = line @ view[:2].T
        assert (seen >= limits.min(axis=0) - 1e-6).all() and (seen <= limits.max(axis=0) + 1e-6).all()
        if isinstance(cavity, rb.SphericalCavity):
            assert np.linalg.norm(seen, axis=1).max() < 18e-3 + 1e-6
    figure = rb.plot_case(on(SDOF, lattice))
    assert is_within_page(figure)
    for length in cavity.lengths[[0, 2]]:
        assert amount(length, "m") in texts(figure)


STRUCTURES = {
    "oscillator": (SDOF, "mass"),
    "beam": (beam(), "tip"),
    "plate": (rb.Plate(length="0.7 m", width="0.5 m", thickness="4 mm", material="steel"), "middle"),
    "building": (rb.ShearBuilding(masses=["12 t"] * 2, stiffnesses=["9 MN/m"] * 2), "storey 2"),
    "modes": (rb.Modal(frequencies=[8], damping_ratio=0.01, shapes={"tip": [0.5], "root": [0.1]}), "tip"),
}


@pytest.mark.parametrize("name", STRUCTURES)
def test_dampers_in_tuned_masses_are_drawn(name: str) -> None:
    """Only an oscillator had a drawing of a damper in its tuned mass, at the wrong place; no test had another structure."""
    structure, point = STRUCTURES[name]
    carried = BALL.model_copy(update={"point": "tuned mass"})
    other = BALL.model_copy(update={"point": point, "gap": 1e-3, "name": "other"})
    case = on(
        structure,
        carried,
        other,
        tuned_masses=rb.TunedMass(mass="1 kg", frequency="9.5 Hz", point=point),
        loads=FORCE.model_copy(update={"point": "tuned mass"}),
    )
    figure = rb.plot_case(case)
    assert is_within_page(figure)
    if name == "modes":
        assert "at tip (2, 1)" in texts(figure)
        return
    marks = {each.get_text(): each.get_position()[1] for each in figure.axes[0].texts}
    assert {"1", "2"} <= set(marks)
    assert name in ("plate", "building") or marks["1"] > marks["2"]
