"""Cells: identical cavities at offsets from the point of a damper."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import particle_dampers

import rattlebox as rb

OFFSETS = (("-15 mm", "0 mm", "0 mm"), ("25 mm", "0 mm", "5 mm"))


def damper(**changes: Any) -> rb.ParticleDamper:
    """Return a box with a few balls."""
    usual: dict[str, Any] = {
        "particles": particle_dampers.balls(8),
        "cavity": rb.Box(size=("20 mm", "20 mm", "16 mm")),
        "contact": rb.Tsuji(restitution=0.6),
        "packing": rb.Settled(seed=3),
        "softening": 1000,
    }
    return particle_dampers.damper(**(usual | changes))


def case(*dampers: rb.ParticleDamper, **changes: Any) -> rb.Case:
    """Return dampers on a vibrating mass."""
    values: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="120 Hz", damping_ratio=0.005, displacement="0.2 mm"),
        "dampers": dampers,
        "duration": "20 ms",
    }
    return rb.Case(**(values | changes))


def turning(arm: tuple[str, str, str]) -> rb.Rotation:
    """Return a rotation about y."""
    return rb.Rotation(speed="500 rpm", axis="y", arm=arm)


def test_cells_that_turn_have_fields_of_their_own() -> None:
    """Two cells at different radii have the bits of two dampers with these arms and the packings of the cells."""
    cells = case(damper(offsets=OFFSETS, rotation=turning(("60 mm", "0 mm", "10 mm"))))
    assert cells.dampers[0].number == 2
    bed = rb.Settled(seed=3)
    alone = case(
        damper(rotation=turning(("45 mm", "0 mm", "10 mm")), packing=bed.repeated(0)),
        damper(rotation=turning(("85 mm", "0 mm", "15 mm")), packing=bed.repeated(1)),
    )
    first, second = (each.field for each in cells.particle_dampers)
    assert np.linalg.norm(second) > 1.5 * np.linalg.norm(first)
    run, other = rb.simulate(cells), rb.simulate(alone)
    assert run.arrays.dampers == ("damper", "damper2")
    assert np.allclose(run.arrays.displacement, other.arrays.displacement, rtol=1e-9, atol=1e-15)
    assert np.allclose(run.arrays.centre_of_mass, other.arrays.centre_of_mass, rtol=1e-9, atol=1e-12)
    assert np.abs(run.arrays.centre_of_mass[:, 0] - run.arrays.centre_of_mass[:, 1]).max() > 1e-4


def test_offsets_without_a_rotation() -> None:
    """The motion of cells that do not turn has the bits of identical dampers without places."""
    run, other = (rb.simulate(case(damper(**cells))) for cells in ({"offsets": OFFSETS}, {"number": 2}))
    assert np.array_equal(run.arrays.displacement, other.arrays.displacement)
    assert np.array_equal(run.arrays.particles.position, other.arrays.particles.position)


def test_case_files_and_studies(tmp_path: Path) -> None:
    """A case with cells is the same after it is written and read, with units, and the cells are an axis of studies."""
    cells = case(damper(offsets=OFFSETS, points=("mass",), rotation=turning(("60 mm", "0 mm", "0 mm"))))
    cells.to_file(tmp_path / "case.toml")
    assert '"25 mm"' in (tmp_path / "case.toml").read_text()
    assert rb.Case.from_file(tmp_path / "case.toml") == cells
    assert rb.Case.from_toml(cells.to_toml()) == cells
    # A case of the cells has the same cells.
    again = case(*cells.particle_dampers)
    assert [each.rotation for each in again.particle_dampers] == [each.rotation for each in cells.particle_dampers]
    wide = cells.replaced({"damper.offsets": [["-30 mm", 0, 0], ["30 mm", 0, 0]]})
    assert [each.rotation.arm[0] for each in wide.particle_dampers] == pytest.approx([0.03, 0.09])
    moved = cells.replaced({"damper.offsets[1][0]": "35 mm"})
    assert moved.particle_dampers[1].rotation.arm[0] == pytest.approx(0.095)
    assert damper(offsets=np.array([[0, 0, 0], [0.05, 0, 0]])).number == 2
    swept = rb.sweep(
        case(damper(offsets=OFFSETS, rotation=turning(("60 mm", "0 mm", "0 mm")))),
        {"damper.rotation.speed": ["100 rpm", "600 rpm"]},
        "rms",
        progress=False,
    )
    assert swept.rms.values[0] != swept.rms.values[1]


def test_one_cell_on_the_axis_and_one_beside_it() -> None:
    """A bed without gravity settles in each cell that is beside the axis, and a cell on the axis is refused."""
    values: dict[str, Any] = {"gravity": (0, 0, 0), "rotation": turning(("0 mm", "0 mm", "0 mm"))}
    cells = damper(offsets=[["-30 mm", 0, 0], ["30 mm", 0, 0]], **values)
    assert [np.sign(each.field[0]) for each in cells.each()] == [-1, 1]
    with pytest.raises(rb.CaseError, match="settle"):
        damper(offsets=[["30 mm", 0, 0], [0, 0, 0]], **values)


def test_one_map_for_cells_in_different_fields() -> None:
    """Limits of cutting multiply the loss map of one cell by their number, which is refused for unequal fields."""
    along = [[0, "-15 mm", 0], [0, "15 mm", 0]]  # the axis
    rotation = turning(("60 mm", "0 mm", "0 mm"))
    assert not damper(offsets=OFFSETS, rotation=rotation).has_equal_cells
    assert damper(offsets=along, rotation=rotation).has_equal_cells
    assert damper(offsets=OFFSETS).has_equal_cells
    cells = case(damper(offsets=OFFSETS, rotation=rotation))
    with pytest.raises(rb.CaseError, match="cells of the damper are in different fields"):
        rb.stability_lobes(cells, None, "2200 N/mm^2", 0.9, amplitudes=["2 um", "20 um"])


TRIANGLE = {
    "vertices": [[0, 0, 0], [40, 0, 0], [40, 0, 20], [0, 30, 0], [40, 30, 0], [40, 30, 20]],
    "faces": [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]],
    "unit": "mm",
}


@pytest.mark.parametrize(
    ("cavity", "free", "overlapping"),
    [
        (rb.Box(size=("20 mm", "20 mm", "16 mm")), (20, 5, 0), (19.9, 5, 0)),
        (rb.Box(size=("20 mm", "20 mm", "16 mm")), (3, 2, 16), (3, 2, 15.9)),
        (rb.Box(size=("20 mm", "20 mm", "16 mm"), periodic="x"), (20, 5, 0), (19.9, 5, 0)),
        (rb.Cylinder(diameter="20 mm", length="16 mm"), (14.2, 14.2, 0), (14.1, 14.1, 0)),
        (rb.Cylinder(diameter="20 mm", length="16 mm"), (2, 2, 16), (2, 2, 15.9)),
        (rb.SphericalCavity(diameter="20 mm"), (11.6, 11.6, 11.6), (11.5, 11.5, 11.5)),
        (rb.Mesh(**TRIANGLE), (0, 0, 20), (0, 0, 18)),
        (rb.Mesh(**TRIANGLE), (-20, 29, 10.1), (-20, 29, 9.5)),
        (rb.Mesh(**TRIANGLE), (-20, 0, 11), (-20, 0, 8)),
    ],
)
def test_cells_that_overlap(cavity: Any, free: Any, overlapping: Any) -> None:
    """Cells may touch and must not overlap; the distance in the message is one at which they do not."""
    damper(cavity=cavity, offsets=1e-3 * np.array([[1, 2, 3], np.add([1, 2, 3], free)]))
    shift = 1e-3 * np.array(overlapping)
    with pytest.raises(rb.CaseError, match=r"offsets\[1\].*\n *cells 1 and 2 overlap") as caught:
        damper(cavity=cavity, offsets=[np.zeros(3), shift])
    length, unit = str(caught.value).split("at least ")[1].split(" apart")[0].split()
    assert unit == "mm"
    apart = 1e-3 * float(length)
    assert apart < 1.3 * np.linalg.norm(shift)
    damper(cavity=cavity, offsets=[np.zeros(3), shift / np.linalg.norm(shift) * apart])


def test_many_cells() -> None:
    """Of a pattern of 900 cells the one that is displaced is named, and cells at one place are found at once."""
    grid = np.stack(np.meshgrid(np.arange(30), np.arange(30), [0.0], indexing="ij"), axis=-1).reshape(-1, 3) * 0.021
    assert damper(offsets=grid).number == 900
    grid[417, 0] += 0.003
    with pytest.raises(rb.CaseError, match="cells 418 and 448 overlap"):
        damper(offsets=grid)
    with pytest.raises(rb.CaseError, match=r"cells \d+ and \d+ overlap: their centres are 0 m apart"):
        damper(offsets=np.zeros((9000, 3)))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"number": 3, "offsets": OFFSETS},
            r"number and offsets must agree: 3 cells, but 2 offsets\n *try: number = 2",
        ),
        ({"offsets": np.arange(30003).reshape(-1, 3)}, "10001 offsets; at most 10000"),
        ({"offsets": ["10 mm", 0, 0]}, "three lengths"),
        ({"offsets": [["10 mm", 0]]}, "three lengths"),
        ({"offsets": [["10 N", 0, 0]]}, "N"),
        ({"offsets": OFFSETS, "packing": rb.Lattice(noise=0)}, "move in step"),
    ],
)
def test_bad_cells_are_refused(changes: dict[str, Any], message: str) -> None:
    """A number that differs from that of the offsets and offsets that are no three lengths are refused."""
    with pytest.raises(rb.CaseError, match=message):
        damper(**changes)
