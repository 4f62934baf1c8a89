"""Snapshots of particles in VTKHDF files, read by our reader and by VTK."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rattlebox as rb
from rattlebox._util.atomic_io import reserve_space
from rattlebox.results.snapshots import SnapshotFile, Snapshots


def case(**output: Any) -> rb.Case:
    """Return balls in a box with initial velocity along x and in a can on the same structure along z."""
    beads = rb.Particles(material="glass", diameter="4 mm", count=9)
    options: dict[str, Any] = {
        "particles": beads,
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.2,
        "softening": 1000,
    }
    box = rb.ParticleDamper(name="box", cavity=rb.Box(size=("20 mm", "16 mm", "12 mm")), direction="x", **options)
    can = rb.ParticleDamper(name="can", cavity=rb.Cylinder(diameter="20 mm", length="20 mm"), direction="z", **options)
    return rb.Case(
        structure=rb.SDOF(mass="0.1 kg", stiffness="10 kN/m", velocity="0.5 m/s"),
        dampers=[box, can],
        duration="20 ms",
        output=rb.Output(rate="1 kHz", **output),
    )


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return a run and the path of its eleven snapshots."""
    path = tmp_path_factory.mktemp("snapshots") / "run.vtkhdf"
    return rb.simulate(case(snapshots=11), snapshots=path), path


def test_snapshots_agree_with_the_run(written: Any) -> None:
    """Times, centres of mass, displacements, and the last positions and velocities are those of the run."""
    run, path = written
    result = Snapshots(path)
    assert len(result) == 11
    np.testing.assert_allclose(result.times, np.linspace(0, 0.02, 11), atol=run.diagnostics["step"])
    for frame, place in zip(result, np.searchsorted(run.arrays.time, result.times - 1e-9), strict=True):
        np.testing.assert_allclose(frame.displacement, run.arrays.cavity_displacement[place], atol=1e-15)
        for d in range(2):
            here = frame.cavity == d
            centre = frame.mass[here] @ frame.position[here] / frame.mass[here].sum() - frame.displacement[d]
            np.testing.assert_allclose(centre, run.arrays.centre_of_mass[place, d], atol=1e-9)
    last = result[-1]
    np.testing.assert_array_equal(last.velocity, run.arrays.particles.velocity)
    np.testing.assert_allclose(
        last.position - last.displacement[last.cavity], run.arrays.particles.position, atol=1e-15
    )
    assert result.case_toml == run.case_toml


def test_contact_force_of_a_stack(tmp_path: Path) -> None:
    """The contact force on the upper of two stacked balls is its weight, on the lower one three times the weight."""
    steel = rb.Particles(material="steel", diameter="10 mm")
    pile = rb.ParticleDamper(
        particles=steel,
        cavity=rb.Cylinder(diameter="10.02 mm", length="30 mm"),
        contact=rb.Linear(contact_time="1 ms", restitution=0.1),
        packing=rb.Positions(positions=[(0.0, 0.0, -9.9e-3), (0.0, 0.0, 0.2e-3)]),
    )
    still = rb.Case(structure=rb.Fixed(), damper=pile, duration="0.3 s", output=rb.Output(snapshots=["0.3 s"]))
    rb.simulate(still, snapshots=tmp_path / "run.vtkhdf")
    frame = rb.Snapshots(tmp_path / "run.vtkhdf")[0]
    assert frame.contact_force / (9.81 * frame.mass[0]) == pytest.approx([3, 1], rel=1e-2)


def edges(frame: Any) -> tuple[float, float]:
    """Return the smallest and the largest x of the walls of the box and the can."""
    return frame.displacement[0, 0] - 0.01, 1.25 * 0.02 + frame.displacement[1, 0] + 0.01


CAVITIES = [
    rb.Box(size=("20 mm", "16 mm", "12 mm")),
    rb.Cylinder(diameter="20 mm", length="30 mm"),
    rb.Cylinder(radius="1 m", length="0.1 m", axis=(1, 2, 3)),
    rb.SphericalCavity(radius="3 mm"),
]


@pytest.mark.parametrize("cavity", CAVITIES)
def test_surface_of_a_cavity(cavity: Any) -> None:
    """The surface is closed, its corners are on the walls, its faces point inward, and its volume is the cavity's."""
    walls = cavity.surface()
    np.testing.assert_allclose(cavity.depth(walls.points), 0, atol=1e-12 * cavity.lengths.max())
    sides = [(a, b) for face in walls.polygons for a, b in zip(face, (*face[1:], face[0]), strict=True)]
    assert len(sides) == len(set(sides)) and {(b, a) for a, b in sides} == set(sides)
    volume = 0.0
    for face in walls.polygons:
        corners = walls.points[list(face)]
        fans = [np.linalg.det([corners[0], corners[k], corners[k + 1]]) for k in range(1, len(face) - 1)]
        assert max(fans) <= 1e-12 * cavity.volume
        volume -= sum(fans) / 6
    assert volume == pytest.approx(cavity.volume, rel=0.015) and volume <= cavity.volume * (1 + 1e-12)


def test_walls_move_with_the_structure(written: Any) -> None:
    """The file has the walls of both cavities after the particles, displaced with their cavity at each time."""
    run, path = written
    walls = [damper.cavity.surface().points for damper in run.case.dampers]
    total = 18 + sum(map(len, walls))
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        assert list(root["NumberOfPoints"]) == [total] and len(root["Points"]) == 11 * total
        assert root["Vertices/NumberOfCells"][0] == 18
        assert root["Polygons/Offsets"][-1] == len(root["Polygons/Connectivity"]) == 6 * 4 + 72 * 4 + 2 * 72
        assert set(root["Polygons/Connectivity"]) == set(range(18, total))
        points = root["Points"][...].reshape(11, total, 3)
        moved = root["FieldData/displacement"][...].reshape(11, 2, 3)
        for k, (first, corners) in enumerate(zip((18, 26), walls, strict=True)):
            here = corners + root["FieldData/place"][k]
            np.testing.assert_allclose(points[:, first : first + len(here)], here + moved[:, None, k], atol=1e-15)
        assert np.ptp(moved[:, 0, 0]) > 1e-3, "the box moves"


def test_vtk_reads_the_file(written: Any) -> None:
    """VTK's reader reads every time, point, field and the displacements of the cavities, which are side by side."""
    pytest.importorskip("vtkmodules", reason="VTK is not installed: python -m pip install 'rattlebox[3d]'")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    _, path = written
    result = Snapshots(path)
    reader = vtkHDFReader()
    assert reader.CanReadFile(str(path))
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 11
    for step, frame in enumerate(result):
        reader.SetStep(step)
        reader.Update()
        assert reader.GetTimeValue() == frame.time
        cloud = reader.GetOutput()
        assert cloud.GetNumberOfVerts() == 18
        points = vtk_to_numpy(cloud.GetPoints().GetData())[:18]
        aside = np.where(frame.cavity == 1, 1.25 * 0.02, 0.0)
        np.testing.assert_allclose(points, frame.position + np.outer(aside, [1, 0, 0]), atol=1e-16)
        for name in ("velocity", "spin", "contact_force", "radius", "mass", "cavity", "species"):
            stored = vtk_to_numpy(cloud.GetPointData().GetArray(name))
            np.testing.assert_array_equal(stored[:18], getattr(frame, name))
            assert name == "cavity" or np.all(stored[18:] == (-1 if name == "species" else 0))
        assert cloud.GetNumberOfPolys() == 6 + 74 and cloud.GetBounds()[:2] == pytest.approx(edges(frame), abs=1e-15)
        moved = vtk_to_numpy(cloud.GetFieldData().GetArray("displacement"))
        np.testing.assert_array_equal(moved, frame.displacement)
        assert np.abs(moved[:, 1]).max() == 0


@pytest.mark.parametrize(("steps", "count", "cavities"), [(2, 1, 1), (500, 3, 2), (2, 20_000, 1), (40, 200, 30)])
def test_disk_space_is_reserved_at_once(steps: int, count: int, cavities: int, tmp_path: Path) -> None:
    """The reserved space is enough for the file, and the file has no holes that need space later."""
    fixed = {name: np.ones(count) for name in ("radius", "mass", "cavity", "species")}
    walls = [rb.SphericalCavity(radius=1).surface()] * cavities
    text = "# ein längerer Fall\n" * 1000
    file = SnapshotFile(
        tmp_path / "run.vtkhdf", np.arange(steps), np.zeros((cavities, 3)), fixed, walls, text, "numbers"
    )
    sizes: list[int] = []
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(
            "rattlebox.results.snapshots.reserve_space",
            lambda path, size: (sizes.append(size), reserve_space(path, size)),
        )
        file.create()
    size = (tmp_path / "run.vtkhdf").stat().st_size
    assert sizes[1] == size <= sizes[0] < size + 100_000
    if hasattr(os, "posix_fallocate"):
        assert 512 * (tmp_path / "run.vtkhdf").stat().st_blocks >= size


def test_times_of_snapshots(tmp_path: Path) -> None:
    """Snapshots are taken at the steps nearest to the given times, each once."""
    times = [0.0, 0.005, 0.00500001, 0.02 * (1 + 1e-15)]
    run = rb.simulate(case(snapshots=times), snapshots=tmp_path / "run.vtkhdf")
    result = Snapshots(tmp_path / "run.vtkhdf")
    assert len(result) == 3
    assert abs(result.times - [0, 0.005, 0.02]).max() <= run.diagnostics["step"] / 2


def test_times_after_the_end_are_refused() -> None:
    """A snapshot after the end of the run is refused with both times."""
    with pytest.raises(rb.CaseError) as caught:
        case(snapshots=["5 ms", "30 ms", "1 s"])
    assert str(caught.value).splitlines() == [
        "Case: output.snapshots = (0.005, 0.03, 1.0)",
        "  the snapshot at 0.03 s is after the end of the run at 0.02 s",
        "  try: times up to the end, or a longer duration",
    ]


def test_no_times_give_no_file(tmp_path: Path) -> None:
    """With an empty list of times no file is needed, and none is written."""
    assert rb.simulate(case(snapshots=[])).ok
    assert rb.simulate(case(snapshots=[]), snapshots=tmp_path / "run.vtkhdf").ok
    assert not (tmp_path / "run.vtkhdf").exists()


def test_snapshots_do_not_change_the_run(written: Any) -> None:
    """Runs with and without snapshots have the same bits."""
    run, _ = written
    plain = rb.simulate(case())
    np.testing.assert_array_equal(plain.arrays.cavity_force, run.arrays.cavity_force)
    np.testing.assert_array_equal(plain.arrays.particles.position, run.arrays.particles.position)


@pytest.mark.parametrize(("content", "message"), [(None, "there is no file"), (b"notes", "is not an intact HDF5 file")])
def test_other_files_are_refused(content: bytes | None, message: str, tmp_path: Path) -> None:
    """A missing file, a folder and a file of another format are refused."""
    path = tmp_path / "run.vtkhdf"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(rb.DataError, match=message):
        Snapshots(path)
    with pytest.raises(rb.DataError, match="is a folder, not a file"):
        Snapshots(tmp_path)


def test_other_files_are_not_overwritten(written: Any, tmp_path: Path) -> None:
    """Snapshots never overwrite results or notes, but do overwrite earlier snapshots, even truncated ones."""
    results, notes, torn = (tmp_path / name for name in ("results", "notes.txt", "torn.vtkhdf"))
    written[0].save(results)
    notes.write_text("buy milk")
    for path in (results, notes):
        before = path.read_bytes()
        with pytest.raises(rb.DataError, match="is not overwritten\n  try: another file"):
            rb.simulate(case(snapshots=2), snapshots=path)
        assert path.read_bytes() == before
    torn.write_bytes(written[1].read_bytes()[:4000])
    rb.simulate(case(snapshots=2), snapshots=torn)
    assert len(Snapshots(torn)) == 2


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("run.csv", "a .vtkhdf file is written, not a .csv file\n  try: run.vtkhdf"),
        ("no/run.vtkhdf", "there is no folder"),
    ],
)
def test_bad_paths_of_snapshots_are_refused(tmp_path: Path, name: str, message: str) -> None:
    """Files with another suffix and in missing folders are refused before the run."""
    with pytest.raises((rb.CaseError, OSError), match=message):
        rb.simulate(case(snapshots=2), snapshots=tmp_path / name)
    assert not any(tmp_path.iterdir())


def test_runs_are_no_snapshots(written: Any, tmp_path: Path) -> None:
    """The netCDF file of a run, which is HDF5 too, has no snapshots; an index beyond the last is refused."""
    run, path = written
    with pytest.raises(rb.DataError, match="holds no snapshots of particles"):
        Snapshots(run.save(tmp_path / "run.nc"))
    with pytest.raises(IndexError, match="holds 11 snapshots; 11 is not from 0 to 10"):
        Snapshots(path)[11]


def test_several_snapshots_at_once(written: Any) -> None:
    """A slice of snapshots selects as a slice of a list."""
    there = Snapshots(written[1])
    times = list(there.times)
    for some in (slice(2, 5), slice(None, None, 4), slice(-2, None), slice(5, 2)):
        assert [frame.time for frame in there[some]] == times[some]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (1, "at least two snapshots are needed"),
        (True, "a number of snapshots"),
        ("5 ms", "a list of times"),
        ([-1.0], "negative"),
    ],
)
def test_wrong_choices_are_refused(value: Any, message: str) -> None:
    """Invalid values of `snapshots` are refused."""
    with pytest.raises(rb.CaseError, match=message):
        rb.Output(snapshots=value)


def test_more_snapshots_than_steps_are_refused(tmp_path: Path) -> None:
    """Five snapshots of a run with three steps, that is four instants, are refused, and nothing is written."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="3 mm", count=2),
            cavity=rb.Box(size=("30 mm",) * 3),
            contact=rb.Tsuji(restitution=0.9),
            velocity=(0.1, 0, 0),
        ),
        duration=3e-7,
        output=rb.Output(snapshots=5, times=[3e-7]),
        method=rb.Dem(dt=1e-7),
    )
    path = tmp_path / "run.vtkhdf"
    message = r"output\.snapshots\n  5 is more than the 3 steps of the run\n  try: snapshots = 4"
    with pytest.raises(rb.CaseError, match=message):
        rb.simulate(case, snapshots=path)
    assert not path.exists()


def test_snapshots_are_no_run(written: Any) -> None:
    """Loading a file of snapshots as a run is refused with its content."""
    with pytest.raises(rb.DataError, match=r"run\.vtkhdf holds snapshots of particles, not a run"):
        rb.load(written[1])


def test_damaged_snapshots_are_refused(written: Any, tmp_path: Path) -> None:
    """A file without a required part is refused with its name, on opening or on reading a snapshot."""
    for lost in ("Steps", "PointData/radius", "PointData/spin"):
        path = tmp_path / "run.vtkhdf"
        path.write_bytes(written[1].read_bytes())
        with h5py.File(path, "r+") as file:
            del file["VTKHDF"][lost]
        with pytest.raises(rb.DataError, match=r"run\.vtkhdf is damaged: its description"):
            _ = Snapshots(path)[0]
    with h5py.File(path, "r+") as file:
        del file.attrs["case"]
    with pytest.raises(rb.DataError, match=r"run\.vtkhdf is damaged: its description"):
        Snapshots(path)
