"""Places of cells in pictures, drawings, the browser and files of snapshots."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rattlebox as rb
from rattlebox.app import views

OFFSETS = 1e-3 * np.array([[-15.0, 0.0, 0.0], [25.0, 0.0, 5.0], [5.0, 0.0, 25.0]])
SIZE = np.array([0.02, 0.02, 0.016])


def case(**changes: Any) -> rb.Case:
    """Return a damper with three cells."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=8),
        cavity=rb.Box(size=SIZE.tolist()),
        contact=rb.Tsuji(restitution=0.6),
        softening=1000,
        **changes,
    )
    return rb.Case(
        structure=rb.SDOF(mass="1 kg", frequency="120 Hz", displacement="0.2 mm"),
        damper=damper,
        duration="10 ms",
        output=rb.Output(snapshots=3),
    )


TURNING = {"rotation": rb.Rotation(speed="300 rpm", axis="y", arm=("60 mm", "0 mm", "0 mm"))}


@pytest.mark.parametrize("changes", [{}, TURNING])
def test_cells_are_at_their_offsets(changes: dict[str, Any], tmp_path: Path) -> None:
    """The picture of a run and the file of its snapshots show particles and walls of each cell around its offset."""
    path = tmp_path / "run.vtkhdf"
    run = rb.simulate(case(offsets=OFFSETS, **changes), snapshots=path)
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        assert np.allclose(root["FieldData/place"], OFFSETS)
    snapshots = rb.Snapshots(path)
    frame = snapshots[-1]
    for number in range(len(OFFSETS)):
        # Positions in frames remain relative to the point of the structure, like those of a single cavity.
        inside = frame.position[frame.cavity == number]
        assert np.all(np.abs(inside) < SIZE / 2 + 1e-3), number
    for drawn in (run, snapshots):
        figure = rb.plot_particles(drawn, view="front", renderer="plain")
        (axes,) = [axes for axes in figure.axes if axes.images]
        lines = [np.array(line.get_xydata()) for line in axes.lines[:-1]]
        middles = np.array([wall.get_xy().min(axis=0) + wall.get_xy().max(axis=0) for wall in axes.patches]) / 2
        assert np.allclose(middles - middles[0], (OFFSETS - OFFSETS[0])[:, [0, 2]], atol=1e-4)
        corners = np.concatenate(lines)
        assert np.ptp(corners[:, 0]) == pytest.approx(0.04 + SIZE[0], abs=1e-4)
        assert np.ptp(corners[:, 1]) == pytest.approx(0.025 + SIZE[2], abs=1e-4)
        picture = axes.images[0]
        left, right, low, high = picture.get_extent()
        alpha = picture.get_array()[..., 3] > 0
        height, width = alpha.shape
        for middle in middles:  # spheres are drawn within each cell
            column = int((middle[0] - left) / (right - left) * width)
            row = int((high - middle[1]) / (high - low) * height)
            reach = int(0.008 / (right - left) * width)
            assert alpha[max(0, row - reach) : row + reach, column - reach : column + reach].any()
    places = np.array([cavity["place"] for cavity in views._cavities(run.case)])
    assert np.allclose(places - places[0], OFFSETS - OFFSETS[0])
    # The drawing of the case showed the first cell only, and its test counted panels.
    _, panel = rb.plot_case(run.case).axes
    assert np.allclose(panel.images[0].get_extent(), [-0.025, 0.035, -0.008, 0.033])
    corners = np.concatenate([np.array(line.get_xydata()) for line in panel.lines])
    for x, _, z in OFFSETS:
        for side in np.array([x, z]) + np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]]) * SIZE[[0, 2]] / 2:
            assert np.linalg.norm(corners - side, axis=1).min() < 1e-9
    assert "3 cells, in each:" in " ".join(words.get_text() for words in panel.texts)


def test_two_points_with_cells() -> None:
    """The cells of two dampers are drawn side by side without overlap, and those without offsets have a panel each."""
    both = rb.Case(
        structure=rb.SDOF(mass="1 kg", frequency="120 Hz", displacement="0.2 mm"),
        dampers=[*case(offsets=OFFSETS).dampers, *case(number=2).dampers],
        duration="1 ms",
    )
    figure = rb.plot_particles(rb.simulate(both), renderer="plain")
    titles = [axes.get_title(loc="left").split(",")[0] for axes in figure.axes if axes.images]
    assert titles == ["dampers 1 to 3", "damper 4", "damper 5"]
    places = np.array([cavity["place"] for cavity in views._cavities(both)])
    assert len(places) == 5
    for k in range(5):
        for other in range(k):
            assert np.any(np.abs(places[k] - places[other]) > SIZE - 1e-12)


def test_words_of_a_flat_drawing_are_in_its_panel() -> None:
    """In the drawing of a row of cells the arrow of gravity is in the panel, and no dimension is written on its line.

    Drawings were tested for cells that are about as high as wide, and for the words alone.
    """
    figure = rb.plot_case(case(offsets=[[0.03 * k, 0, 0] for k in range(6)]))
    figure.canvas.draw()
    _, panel = figure.axes
    (gravity,) = [words for words in panel.texts if words.get_text() == "g"]
    assert panel.get_ylim()[0] < gravity.get_position()[1] < panel.get_ylim()[1]
    (height,) = [words for words in panel.texts if words.get_text() == "16 mm"]
    lines = max(line.get_window_extent().x1 for line in panel.lines)
    assert height.get_rotation() == 90 and height.get_window_extent().x0 > lines - 1
