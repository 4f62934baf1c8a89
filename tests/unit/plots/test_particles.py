"""Pictures and films of particles, drawn with and without PyVista."""

from __future__ import annotations

import math
import signal
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import rattlebox as rb
from rattlebox.cli.main import main
from rattlebox.model.cavities import Cavity
from rattlebox.plots.particles import VIEW, _Scene, film_particles, plot_particles, view_axes
from rattlebox.plots.spheres import draw_spheres

EXTENT = (-2.0, 2.0, -1.0, 1.0)
RED, BLUE = [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]


@cache
def renders() -> bool:
    """Return whether PyVista is installed and can draw off screen, tested in another process because it may crash."""
    script = "import pyvista as p; a = p.Plotter(off_screen=True); a.add_mesh(p.Sphere()); a.screenshot()"
    return subprocess.run([sys.executable, "-c", script], capture_output=True, timeout=120, check=False).returncode == 0


@pytest.fixture(params=["plain", "pyvista"])
def renderer(request: pytest.FixtureRequest) -> Any:
    """Return each of the two renderers."""
    if request.param == "pyvista" and not renders():
        pytest.skip("PyVista is not here or cannot draw: python -m pip install 'rattlebox[3d]', and a Mesa library")
    return request.param


def picture(places: Any, radii: Any, colours: Any, renderer: Any) -> Any:
    """Draw spheres, 400 pixels wide."""
    return draw_spheres(np.array(places, float), np.array(radii), np.array(colours), EXTENT, 400, renderer)


def test_a_sphere_is_a_disc_of_its_size_and_place(renderer: Any) -> None:
    """A sphere covers a disc of its radius at its position, lit from the upper left, on a transparent background."""
    drawn = picture([[1.0, 0.25, 0.0]], [0.5], [RED], renderer)
    assert drawn.shape == (200, 400, 4)
    cover = drawn[..., 3] / 255.0
    assert cover.sum() == pytest.approx(np.pi * 50**2, rel=0.01)
    rows, columns = np.indices(cover.shape)
    assert (cover * columns).sum() / cover.sum() == pytest.approx(299.5, abs=0.5)
    assert (cover * rows).sum() / cover.sum() == pytest.approx(74.5, abs=0.5)
    assert drawn[50, 280, 0] > 1.5 * drawn[100, 320, 0]
    assert drawn[75, 300, 1] < 30


def test_the_nearer_sphere_is_visible(renderer: Any) -> None:
    """The nearer of two spheres hides the other, in any order of drawing."""
    for order in ([0, 1], [1, 0]):
        places, colours = np.array([[0, 0, 1.0], [0, 0, -1.0]])[order], np.array([RED, BLUE])[order]
        middle = picture(places, [0.5, 0.5], colours, renderer)[100, 200]
        assert middle[0] > 100 > middle[2]


def test_both_renderers_agree() -> None:
    """PyVista and the plain renderer cover the same pixels with nearly the same colours."""
    if not renders():
        pytest.skip("PyVista is not here or cannot draw: python -m pip install 'rattlebox[3d]', and a Mesa library")
    generator = np.random.default_rng(1)
    places = generator.uniform([-2, -1, -1], [2, 1, 1], (60, 3))
    spheres = places, generator.uniform(0.05, 0.2, 60), generator.uniform(0.2, 0.8, (60, 3))
    plain, pyvista = (picture(*spheres, way) / 255.0 for way in ("plain", "pyvista"))
    assert np.abs(plain[..., 3] - pyvista[..., 3]).mean() < 0.01
    both = (plain[..., 3] == 1) & (pyvista[..., 3] == 1)
    assert np.median(np.abs(plain - pyvista)[both]) < 0.03


@pytest.mark.parametrize(
    ("cavity", "edges", "length"),
    [
        (rb.Box(size=(1, 2, 3)), 12, 24.0),
        # Two rims and two lines of the side, as seen obliquely; two rims along the axis.
        (rb.Cylinder(radius=1, length=2), 2 * 72 + 2, 4 * np.pi + 4),
        (rb.Cylinder(radius=1, length=2, axis=tuple(VIEW[2])), 2 * 72, 4 * np.pi),
        (rb.SphericalCavity(radius=1), 72, 2 * np.pi),
    ],
)
def test_outlines_lie_on_the_walls(cavity: Cavity, edges: int, length: float) -> None:
    """Every corner of an outline lies on a wall of the cavity, and no edge is drawn twice or missing."""
    drawn = cavity.outline(VIEW)
    assert sum(len(line) - 1 for line in drawn) == edges
    total = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in drawn)
    assert total == pytest.approx(length, rel=4e-4)
    for line in drawn:
        np.testing.assert_allclose(cavity.depth(line), 0, atol=1e-12)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return a run with two cavities and the path of its snapshots."""
    options: dict[str, Any] = {
        "particles": rb.Particles(material="glass", diameter="4 mm", count=20),
        "contact": rb.Tsuji(restitution=0.7),
        "softening": 1000,
    }
    case = rb.Case(
        structure=rb.SDOF(mass="0.1 kg", stiffness="10 kN/m", velocity="0.5 m/s"),
        dampers=[
            rb.ParticleDamper(name="box", cavity=rb.Box(size=("20 mm", "16 mm", "12 mm")), **options),
            rb.ParticleDamper(name="can", cavity=rb.Cylinder(diameter="20 mm", length="20 mm"), **options),
        ],
        duration="20 ms",
        output=rb.Output(rate="1 kHz", snapshots=5),
    )
    folder = tmp_path_factory.mktemp("run")
    result = rb.simulate(case, snapshots=folder / "run.vtkhdf")
    result.save(folder / "run.nc")
    return result, folder / "run.vtkhdf"


def test_a_figure_has_a_panel_for_each_cavity(run: Any) -> None:
    """Each panel has its cavity and time as title, a colour bar shows the speed, and balls are inside the outline."""
    for of in (run[0], rb.Snapshots(run[1])):
        figure = plot_particles(of, size="column", renderer="plain")
        *panels, bar = figure.axes
        assert [axes.get_title(loc="left") for axes in panels] == ["box, 20 ms", "can, 20 ms"]
        assert bar.get_ylabel() == "Speed (mm/s)"
        for axes in panels:
            image = axes.get_images()[0]
            rows, columns = np.nonzero(image.get_array()[..., 3])
            left, right, bottom, top = image.get_extent()
            height, width = image.get_array().shape[:2]
            lines = np.concatenate([line.get_xydata() for line in axes.lines[:-1]])
            across = left + (right - left) * np.array([columns.min(), columns.max() + 1]) / width
            upwards = top - (top - bottom) * np.array([rows.max() + 1, rows.min()]) / height
            for seen, shown in zip((across, upwards), lines.T, strict=True):
                pixel = (right - left) / width
                assert shown.min() - 2 * pixel < seen[0] < seen[1] < shown.max() + 2 * pixel


@pytest.mark.parametrize("shaken", ["base", "shaker"])
def test_speeds_in_a_shaken_box_are_relative(shaken: str, tmp_path: Path) -> None:
    """With base motion, the label of the colour bar states that speeds are relative to the base."""
    push = rb.Harmonic(amplitude="1 mm", frequency="30 Hz")
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="glass", diameter="4 mm", count=5),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.7),
        softening=1000,
    )
    moved = (
        {"structure": rb.Shaker(motion=push)}
        if shaken == "shaker"
        else {
            "structure": rb.SDOF(mass="0.1 kg", stiffness="10 kN/m"),
            "base": rb.HalfSine(amplitude=5, duration="9 ms"),
        }
    )
    case = rb.Case(**moved, damper=damper, duration="10 ms", output=rb.Output(rate="1 kHz"))
    figure = plot_particles(rb.simulate(case), size="column", renderer="plain")
    assert figure.axes[-1].get_ylabel() == "Speed relative\nto the base (mm/s)"


def test_films_have_a_picture_for_each_snapshot(run: Any, tmp_path: Path) -> None:
    """A GIF has a different picture for each snapshot."""
    path = film_particles(rb.Snapshots(run[1]), tmp_path / "film.gif", rate=10, renderer="plain")
    with Image.open(path) as film:
        assert film.n_frames == 5 and film.size == (1280, 720)
        assert film.info["duration"] == 100
        frames = []
        for number in range(5):
            film.seek(number)
            frames.append(film.convert("RGB").tobytes())
    assert len(set(frames)) == 5
    with pytest.raises(ValueError, match=r"a film is \.gif or \.mp4"):
        film_particles(rb.Snapshots(run[1]), tmp_path / "film.avi")


def test_colours_and_views(run: Any) -> None:
    """Particles are coloured by speed, spin, radius, species or not at all; a view is a name or two angles."""
    snapshots = rb.Snapshots(run[1])
    labels = {}
    for colour in ("speed", "spin", "radius", "species", "none"):
        figure = plot_particles(snapshots, colour=colour, size="column", renderer="plain")  # type: ignore[arg-type]
        labels[colour] = figure.axes[-1].get_ylabel() if colour != "none" else str(len(figure.axes))
    assert labels["species"] == "Species" and labels["none"] == "2"
    assert labels["spin"].startswith("Spin (") and labels["spin"].endswith("rad/s)") and "m)" in labels["radius"]
    np.testing.assert_allclose(view_axes("top"), [[1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(view_axes("front"), [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-15)
    np.testing.assert_allclose(view_axes((0.0, 0.0)), [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
    for view in ("below", (1.0,), (0.0, 91.0), (math.nan, 0.0)):
        with pytest.raises(ValueError, match="view "):
            plot_particles(snapshots, view=view)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="colour 'heat' is not one of"):
        plot_particles(snapshots, colour="heat")  # type: ignore[arg-type]


def test_the_wall_is_filled_and_moves(run: Any) -> None:
    """Each cavity is filled up to its outline, and the fill moves with the cavity."""
    scene = _Scene(rb.Snapshots(run[1]), run[0].case_toml, "slide", "plain", 60.0, view="front", shape=0.5625)
    frames = list(rb.Snapshots(run[1]))
    for number in (0, 2):
        scene.show(number)
        middle, moved = frames[number].displacement[0, 0], scene._panels[0].walls[0].get_xy()
        assert moved[:, 0].min() == pytest.approx(middle - 0.01) and moved[:, 0].max() == pytest.approx(middle + 0.01)
    assert frames[0].displacement[0, 0] != frames[2].displacement[0, 0]


@pytest.mark.parametrize("pixels", [(1281, 720), (100, 100), (1280,), "1280x720"])
def test_odd_sizes_of_films_are_refused(pixels: Any, run: Any, tmp_path: Path) -> None:
    """Width and height must be even numbers, as video codecs require."""
    with pytest.raises(ValueError, match="even numbers"):
        film_particles(rb.Snapshots(run[1]), tmp_path / "film.gif", pixels=pixels)


def test_films_for_talks(run: Any, tmp_path: Path) -> None:
    """An MP4 is written if imageio-ffmpeg is installed."""
    pytest.importorskip("imageio_ffmpeg", reason="no imageio-ffmpeg: python -m pip install 'rattlebox[3d]'")
    path = film_particles(rb.Snapshots(run[1]), tmp_path / "film.mp4", pixels=(320, 180), renderer="plain")
    assert path.read_bytes()[4:8] == b"ftyp"


def answer(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *arguments: object
) -> tuple[int | str | None, str, str]:
    """Run `rattlebox plot`; return its exit code, standard output and standard error."""
    monkeypatch.setattr(sys, "argv", ["rattlebox", "plot", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code or 0, *capsys.readouterr()


def test_the_command_draws_and_films(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command draws a run or a snapshot, films snapshots, and without PyVista prints how to install it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("rattlebox.plots.spheres.find_spec", lambda name: None)
    get = "drawn without PyVista, which uses the graphics card: python -m pip install 'rattlebox[3d]'\n"
    saved = run[1].with_suffix(".nc")
    for arguments in ([saved, "--kind", "particles"], [run[1]], [run[1], "--number", 0]):
        assert answer(monkeypatch, capsys, *arguments, "-o", "a.png", "--size", "column") == (
            0,
            f"{get}written: a.png\n",
            "",
        )
    assert answer(monkeypatch, capsys, saved, "-o", "a.png") == (0, "written: a.png\n", "")
    film = ["-o", "a.gif", "--pixels", "320x180", "--colour", "spin", "--view", "30,20"]
    assert answer(monkeypatch, capsys, run[1], *film) == (0, f"{get}written: a.gif\n", "")
    with Image.open("a.gif") as made:
        assert made.size == (320, 180)


def test_the_command_draws_the_files_of_a_folder(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """For a folder, the command draws run.nc and films run.vtkhdf; a missing run.vtkhdf is an error."""
    monkeypatch.chdir(tmp_path)
    folder = run[1].parent
    for file, kind in (("run.nc", ["--kind", "energy"]), ("run.vtkhdf", ["--number", 1])):
        options = [*kind, "--size", "column"]
        for of, name in ((folder, "a.png"), (folder / file, "b.png")):
            assert answer(monkeypatch, capsys, of, *options, "-o", name)[0] == 0
        assert Path("a.png").read_bytes() == Path("b.png").read_bytes()
    assert answer(monkeypatch, capsys, folder, "-o", "a.gif", "--pixels", "320x180")[0] == 0
    assert Path("a.gif").read_bytes().startswith(b"GIF89a")
    Path("bare").mkdir()
    Path("bare/run.nc").write_bytes((folder / "run.nc").read_bytes())
    message = "error: bare/run.vtkhdf does not exist\n  try: output.snapshots in the case\n"
    assert answer(monkeypatch, capsys, "bare", "-o", "b.gif") == (2, "", message)


@pytest.mark.parametrize("name", ["film.gif", "film.mp4"])
@pytest.mark.parametrize("pictures", [0, 3])
def test_an_interrupted_film_does_not_replace_the_earlier_one(
    name: str,
    pictures: int,
    run: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Ctrl-C during a film prints one line and does not change an existing file."""
    if name.endswith("mp4"):
        pytest.importorskip("imageio_ffmpeg", reason="no imageio-ffmpeg: python -m pip install 'rattlebox[3d]'")
    drawn, show = 0, _Scene.show

    def press(scene: _Scene, number: int) -> None:
        nonlocal drawn
        drawn += 1
        if drawn == pictures + 2:  # one is drawn for the layout
            signal.raise_signal(signal.SIGINT)
        show(scene, number)

    monkeypatch.setattr(_Scene, "show", press)
    (tmp_path / name).write_text("an earlier film")
    code, out, err = answer(monkeypatch, capsys, run[1], "-o", tmp_path / name, "--pixels", "320x180")
    assert (code, out, err) == (130, "", f"stopped; {tmp_path / name} was not written\n")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["an earlier film"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["run.nc", "-o", "a.gif"], "a film needs the snapshots in run.vtkhdf\n  try: run.vtkhdf"),
        (["run.nc", "--number", "1"], "--number 1: run.nc has no snapshots\n  try: run.vtkhdf"),
        (
            ["run.nc", "--kind", "impacts"],
            "--kind impacts: this run has no such figure\n  try: known: case, energy, motion, particles, phase_portrait",
        ),
        (["run.vtkhdf", "--number", "5"], "holds 5 snapshots; 5 is not from 0 to 4"),
        (["run.vtkhdf", "-o", "a.jpg"], "the suffix must be one of .png, .svg, .pdf, .gif, .mp4"),
        (["run.vtkhdf", "--size", "wide"], "--size wide: unknown size"),
        (["run.vtkhdf", "--number", "0", "-o", "a.gif"], "--number 0: a film shows all snapshots\n  try: -o a.png"),
        (
            ["run.vtkhdf", "--kind", "motion", "-o", "a.gif"],
            "--kind motion: a film can only show particles\n  try: run.nc, -o a.png",
        ),
        (["run.nc", "--of", "loss"], "--of loss: this option is for studies, and run.nc is a run\n  try: --kind"),
        (
            ["run.vtkhdf", "--at", "x=1"],
            "--at x=1: this option is for studies, and run.vtkhdf is a run\n  try: --number",
        ),
        (["nope.nc"], "nope.nc does not exist\n  try: the folder that 'rattlebox run -o' or"),
        (
            [".", "-o", "a.gif", "--size", "page"],
            "--size page: the size of films is in pixels\n  try: --pixels 1280x720",
        ),
        ([".", "-o", "a.gif", "--pixels", "big"], "--pixels big: two numbers are needed\n  try: --pixels 1280x720"),
        ([".", "--pixels", "320x180"], "--pixels 320x180: this option is for films"),
        ([".", "--kind", "energy", "--colour", "spin"], "--colour spin: this option is for pictures of particles"),
        ([".", "--kind", "particles", "--view", "below"], "view 'below' is not one of 'oblique', 'front'"),
        (
            [".", "--kind", "impacts"],
            "--kind impacts: this run has no such figure\n  try: known: case, energy, motion, particles, phase_portrait",
        ),
    ],
)
def test_wrong_arguments_are_refused(
    options: list[str], message: str, run: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Arguments that do not fit the file are refused with the allowed ones."""
    monkeypatch.chdir(run[1].parent)
    code, _, error = answer(monkeypatch, capsys, *options)
    assert code == 2
    assert message in error


def test_films_need_the_extra(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without imageio-ffmpeg the command prints how to install it and which suffix works without."""
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    code, _, error = answer(monkeypatch, capsys, run[1], "-o", tmp_path / "a.mp4")
    assert (code, error) == (
        2,
        "error: imageio_ffmpeg is required and not installed\n"
        "  try: python -m pip install 'rattlebox[3d]', or a name that ends in .gif\n",
    )


def test_runs_without_particles_are_refused(run: Any, tmp_path: Path) -> None:
    """Objects without particles to draw or without snapshots to film are refused."""
    plain = rb.simulate(rb.Case(structure=rb.SDOF(mass=1, stiffness=1, velocity=1), duration=1))
    with pytest.raises(AttributeError, match="has no 'particles'"):
        plot_particles(plain)
    with pytest.raises(TypeError, match=r"a run with particles or its snapshots are needed, not 'run\.nc'"):
        plot_particles("run.nc")  # type: ignore[arg-type]
    for of in (plain, run[0]):
        with pytest.raises(
            TypeError, match=r'snapshots are needed, as rb.Snapshots\("run.vtkhdf"\), not <Run finished'
        ):
            film_particles(of, tmp_path / "a.gif")


def test_damaged_files_are_refused(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Snapshots under the name of a run and truncated files are refused without a traceback."""
    content = run[1].read_bytes()
    for name, size in (("run.nc", None), ("torn.nc", 5000), ("torn.vtkhdf", 5000)):
        (tmp_path / name).write_bytes(content[:size])
        code, _, error = answer(monkeypatch, capsys, tmp_path / name, "-o", tmp_path / "a.png")
        assert code == 2
        assert error.startswith(f"error: {tmp_path / name} {'holds snapshots' if size is None else 'is not a'}")
