"""Snapshots with the names of the common data model of the DEM community."""

from __future__ import annotations

from pathlib import Path

import h5py  # type: ignore[import-untyped]
import numpy as np
import pytest

import rattlebox as rb


@pytest.fixture(scope="module")
def snapshots(tmp_path_factory: pytest.TempPathFactory) -> rb.Snapshots:
    """Snapshots of two cavities, one with two species."""
    glass = rb.Particles(material="glass", diameter="5 mm", count=20)
    steel = rb.Particles(material="steel", diameter="4 mm", count=9)
    dampers = [
        rb.ParticleDamper(
            name=name,
            particles=particles,
            cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
            contact=rb.Tsuji(restitution=0.7),
            friction=0.3,
            softening=1000,
        )
        for name, particles in (("one", [glass, steel]), ("two", [steel]))
    ]
    case = rb.Case(
        structure=rb.SDOF(mass="0.3 kg", stiffness="20 kN/m", velocity="0.4 m/s"),
        dampers=dampers,
        duration="10 ms",
        output=rb.Output(snapshots=3),
    )
    path = tmp_path_factory.mktemp("run") / "run.vtkhdf"
    rb.simulate(case, snapshots=path, progress=False)
    return rb.Snapshots(path)


def test_names_of_the_model(snapshots: rb.Snapshots, tmp_path: Path) -> None:
    """Blocks, fields, scene and materials have the names, types and values of the model; only own names were written."""
    file = snapshots.to_ondem(tmp_path / "last.vtkhdf")
    frame = snapshots[-1]
    with h5py.File(file) as content:
        root = content["VTKHDF"]
        assert root.attrs["Type"] == b"MultiBlockDataSet" and list(root["Assembly"]) == ["particles"]
        block = root["Assembly/particles"]
        assert block.attrs["Type"] == b"PolyData" and block["Vertices/NumberOfCells"][0] == 38
        data = {name: values[...] for name, values in block["PointData"].items()}
        schema = "body_id shape_type material_id clump_id velocity angular_velocity orientation mass volume inertia"
        assert {*schema.split(), "blocked_dofs", "radius"} <= set(data)
        assert {len(values) for values in data.values()} == {38}
        for name, own in (("velocity", frame.velocity), ("angular_velocity", frame.spin), ("radius", frame.radius)):
            np.testing.assert_array_equal(data[name], own)
        np.testing.assert_allclose(data["inertia"][:, 4], 0.4 * frame.mass * frame.radius**2)
        assert block["PointData/orientation"].attrs["order"] == "wxyz"
        scene = content["ONDEM/Scene"]
        assert scene.attrs["time"] == frame.time
        assert scene["shape_names"].asstr()[data["shape_type"][0]] == "sphere"
        assert scene["display_group_names"].asstr()[...].tolist() == ["particles"]
        materials = content["ONDEM/Materials"]
        for number in np.unique(data["material_id"]):
            chosen = data["material_id"] == number
            density = data["mass"][chosen] / data["volume"][chosen]
            np.testing.assert_allclose(density, materials[f"{number}/density"][()])
        assert [materials[f"{number}/label"][()] for number in range(3)] == [b"glass", b"steel", b"steel"]


def test_vtk_reads_it(snapshots: rb.Snapshots, tmp_path: Path) -> None:
    """VTK, on which ParaView is built, reads the block with its points and fields."""
    io = pytest.importorskip("vtkmodules.vtkIOHDF")
    convert = pytest.importorskip("vtkmodules.util.numpy_support")
    reader = io.vtkHDFReader()
    reader.SetFileName(str(snapshots.to_ondem(tmp_path / "first.vtkhdf", 0)))
    reader.Update()
    block = reader.GetOutputDataObject(0).GetBlock(0)
    assert block.GetNumberOfPoints() == block.GetNumberOfVerts() == 38
    frame = snapshots[0]
    np.testing.assert_array_equal(convert.vtk_to_numpy(block.GetPointData().GetArray("radius")), frame.radius)
    np.testing.assert_array_equal(convert.vtk_to_numpy(block.GetPointData().GetArray("velocity")), frame.velocity)


def test_only_own_files_are_replaced(snapshots: rb.Snapshots, tmp_path: Path) -> None:
    """An own file is replaced, a changed one and the snapshots themselves are not."""
    file = snapshots.to_ondem(tmp_path / "a.vtkhdf")
    snapshots.to_ondem(file, 1)
    with h5py.File(file, "r+") as content:
        content["VTKHDF/particles/Points"][0, 0] += 1
    with pytest.raises(rb.DataError, match="not overwritten"):
        snapshots.to_ondem(file)
    with pytest.raises(rb.DataError, match="the file of the snapshots"):
        snapshots.to_ondem(snapshots.path)
    with pytest.raises(IndexError):
        snapshots.to_ondem(tmp_path / "b.vtkhdf", 7)
    assert len(rb.Snapshots(snapshots.path)) == 3
