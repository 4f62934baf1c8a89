"""Files of runs: netCDF, MATLAB and CSV without loss of information."""

from __future__ import annotations

import csv
import zlib
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import pytest

import rattlebox as rb
from rattlebox.results import Provenance, Run, RunArrays, load
from rattlebox.results.snapshots import Snapshots

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_round_trip_is_exact(any_run: Run, tmp_path: Path) -> None:
    """A saved run of any kind is equal in every bit and text when it is loaded."""
    path = any_run.save(tmp_path / "run.nc")
    again = load(path)
    assert again == any_run
    assert again.counts == any_run.counts
    assert again.wall_time == any_run.wall_time
    assert again.provenance == any_run.provenance
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_round_trip_of_odd_values(tmp_path: Path) -> None:
    """Denormals, NaN, infinities, negative zeros, empty and non-ASCII texts are stored exactly."""
    odd = np.array([5e-324, np.nan, np.inf, -np.inf, -0.0, 0.1 + 0.2])
    arrays = RunArrays(
        time=np.arange(6.0),
        points=("Spitze µ", "b"),
        displacement=np.column_stack((odd, odd[::-1])),
    )
    run = Run(arrays, "", Provenance("", "größe", 2**40, "", ""), message="σ > 0")
    again = load(run.save(tmp_path / "odd.nc"))
    assert again == run
    assert again.provenance == run.provenance
    assert np.signbit(again.arrays.displacement[4, 0])


def test_long_case_is_stored(run: Run, tmp_path: Path) -> None:
    """A case file above the size limit of an attribute (64 kB) is stored."""
    case = "times = [" + ", ".join(map(repr, np.linspace(0, 1, 9000).tolist())) + "]\n"
    assert len(case) > 2**16
    assert load(Run(run.arrays, case).save(tmp_path / "long.nc")).case_toml == case


def _visit(file: h5py.File) -> list[tuple[str, Any]]:
    result: list[tuple[str, Any]] = []
    file.visititems(lambda name, item: result.append((name, item)))
    return result


def test_only_plain_types(any_run: Run, tmp_path: Path) -> None:
    """The file has plain numbers and fixed-length characters only: no bool, enum, compound or ragged text."""
    path = any_run.save(tmp_path / "run.nc")
    with h5py.File(path) as file:
        for name, item in [("/", file), *_visit(file)]:
            for key, value in item.attrs.items():
                if key in ("REFERENCE_LIST", "DIMENSION_LIST"):
                    continue
                stored = item.attrs.get_id(key).dtype
                assert stored.kind in "ifS", (name, key)
                assert h5py.check_vlen_dtype(stored) is None
                assert not isinstance(value, str), (name, key)
            if isinstance(item, h5py.Dataset):
                assert item.dtype.kind in "ifS", name
                assert h5py.check_enum_dtype(item.dtype) is None, name
                assert h5py.check_vlen_dtype(item.dtype) is None, name
                assert item.dtype.kind != "S" or item.dtype.itemsize == 1, name
                assert item.dtype.kind == "S" or item.dtype.itemsize in (1, 4, 8), name
                assert item.compression in (None, "gzip"), name


def test_strict_netcdf_reader_reads_everything(run: Run, tmp_path: Path) -> None:
    """A strict netCDF-4 reader reads dimensions, units and long names of every variable."""
    path = run.save(tmp_path / "run.nc")
    with h5netcdf.File(path, "r", invalid_netcdf=False) as file:
        motion = file.groups["motion"]
        assert motion.variables["displacement"].dimensions == ("time", "point")
        np.testing.assert_array_equal(motion.variables["displacement"][...], run.arrays.displacement)
        assert b"".join(motion.variables["point"][0]) == b"mass"
        assert file.groups["impacts"].dimensions["impact"].size == len(run.arrays.impacts)
        assert file.groups["impacts"].variables["complete"].dtype == np.int8
        assert int(file.groups["counts"].variables["impacts"][...]) == len(run.arrays.impacts)
        for group in run.groups:
            for name, variable in file.groups[group].variables.items():
                assert "long_name" in variable.attrs, name


@pytest.mark.parametrize("name", ["steel_ball", "steel_balls_in_a_box"])
def test_counts_and_diagnostics_have_units_and_long_names(name: str, tmp_path: Path) -> None:
    """Each number in the groups of counts and diagnostics has a unit and a long name."""
    case = rb.Case.from_file(EXAMPLES / f"{name}.toml").model_copy(update={"duration": 2e-3})
    with h5netcdf.File(rb.simulate(case).save(tmp_path / "run.nc"), "r") as file:
        rows = [
            item
            for group in ("counts", "diagnostics")
            if group in file.groups
            for item in file.groups[group].variables.items()
        ]
        assert len(rows) > 6
        for variable, item in rows:
            assert "units" in item.attrs, variable
            assert item.attrs["long_name"] not in ("", variable)


def test_derived_energies_are_in_the_file(run: Run, tmp_path: Path) -> None:
    """Derived sums of the energy ledger are stored in the file."""
    path = run.save(tmp_path / "run.nc")
    with h5py.File(path) as file:
        np.testing.assert_array_equal(file["energy/residual"], run.ledger.residual)
        np.testing.assert_array_equal(file["energy/share"], list(run.ledger.shares.values()))


def test_xarray_opens_the_file(two_dampers: Run, tmp_path: Path) -> None:
    """Xarray opens each group with its labels as text and plain times."""
    import xarray

    path = two_dampers.save(tmp_path / "run.nc")
    with xarray.open_dataset(path, group="motion", engine="h5netcdf") as motion:
        assert motion.relative_position.sel(ball="damper2/2").shape == two_dampers.arrays.time.shape
        assert motion.time.dtype == np.float64
    with xarray.open_dataset(path, group="impacts", engine="h5netcdf") as impacts:
        np.testing.assert_array_equal(impacts.peak_force, two_dampers.arrays.impacts.peak_force)


def test_save_is_all_or_nothing(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If writing fails halfway, the older file is unchanged and no temporary file remains."""
    path = run.save(tmp_path / "run.nc")
    before = path.read_bytes()

    def broken(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("rattlebox.results.netcdf._write_coordinate", broken)
    with pytest.raises(OSError, match="disk full"):
        run.save(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_saving_into_no_folder(run: Run, tmp_path: Path) -> None:
    """Saving into a missing folder raises an error."""
    with pytest.raises(rb.DataError, match="no folder"):
        run.save(tmp_path / "missing" / "run.nc")


def test_damage_is_detected(run: Run, tmp_path: Path) -> None:
    """A flipped bit anywhere in a file raises an error or does not change any array with a checksum."""
    path = run.save(tmp_path / "run.nc")
    content = path.read_bytes()
    rng = np.random.default_rng(0)
    messages: list[str] = []
    for _ in range(60):
        damaged = bytearray(content)
        damaged[rng.integers(len(content))] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        try:
            there = load(path)
        except ValueError as error:
            messages.append(str(error))
            continue
        assert there.case_toml == run.case_toml
        for name in ("time", "displacement", "velocity", "ball_position", "ball_velocity", "viscous_loss"):
            np.testing.assert_array_equal(getattr(there.arrays, name), getattr(run.arrays, name))
    assert len(messages) > 30
    assert all("run.nc" in message for message in messages)


def test_checksums_detect_changed_numbers(run: Run, tmp_path: Path) -> None:
    """A block with changed numbers that unpacks without error is refused because of its checksum."""
    path = run.save(tmp_path / "run.nc")
    with h5py.File(path, "r+") as file:
        stored = file["motion/displacement"]
        start = (0,) * stored.ndim
        mask, block = stored.id.read_direct_chunk(start)
        unpacking = zlib.decompressobj()
        numbers = bytearray(unpacking.decompress(block))
        numbers[len(numbers) // 2] ^= 1
        stored.id.write_direct_chunk(start, zlib.compress(bytes(numbers), 4) + unpacking.unused_data, mask)
    with pytest.raises(rb.DataError, match=r"run\.nc"):
        load(path)


def test_loading_something_else(tmp_path: Path) -> None:
    """A missing file, a folder, text, a foreign netCDF file and a later format are refused with the name."""
    with pytest.raises(rb.DataError, match="is a folder, not a file"):
        load(tmp_path)
    with pytest.raises(rb.DataError, match=r"there is no file .*none\.nc"):
        load(tmp_path / "none.nc")
    text = tmp_path / "text.nc"
    text.write_text("not a netCDF file")
    with pytest.raises(rb.DataError, match=r"text\.nc is not an intact netCDF-4 file"):
        load(text)
    foreign = tmp_path / "foreign.nc"
    with h5netcdf.File(foreign, "w") as file:
        file.dimensions["x"] = 1
    with pytest.raises(rb.DataError, match="not a run written by Rattlebox"):
        load(foreign)
    later = Run(RunArrays(time=np.zeros(1)), "", Provenance("99.0")).save(tmp_path / "later.nc")
    with h5py.File(later, "a") as file:
        file.attrs["rattlebox_format"] = np.int32(1000)
    with pytest.raises(
        rb.DataError, match=r"later\.nc has format 1000, and this version .* reads format \d+\n  try: the"
    ):
        load(later)


def test_damaged_files_are_refused(run: Run, tmp_path: Path) -> None:
    """A truncated file and a file without a required part are refused with the name."""
    whole = run.save(tmp_path / "whole.nc").read_bytes()
    damaged = tmp_path / "damaged.nc"
    message = r"damaged\.nc is not an intact netCDF-4 file"
    for size in (0, 100, 5000, len(whole) - 1000):
        damaged.write_bytes(whole[:size])
        with pytest.raises(rb.DataError, match=message):
            load(damaged)
    for lost in ("motion", "impacts/time", "case"):
        damaged.write_bytes(whole)
        with h5py.File(damaged, "a") as file:
            del file[lost]
            del file.attrs["seed"]
        with pytest.raises(rb.DataError, match=r"damaged\.nc is damaged: the group '/'"):
            load(damaged)


def test_a_file_without_permission_to_read(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The error for an unreadable file has the reason of the operating system."""
    path = run.save(tmp_path / "run.nc")

    def forbidden(self: Path, *_: object) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "open", forbidden)
    with pytest.raises(rb.DataError, match=r"run\.nc cannot be read: Permission denied"):
        load(path)
    with pytest.raises(rb.DataError, match=r"run\.nc cannot be read: Permission denied"):
        Snapshots(path)


def test_matlab_file_that_cannot_be_written(run: Run, tmp_path: Path) -> None:
    """A missing folder and a folder of the same name raise the same errors for netCDF and MATLAB files."""
    (tmp_path / "folder").mkdir()
    for write, name in ((run.save, "run.nc"), (run.to_mat, "run.mat")):
        with pytest.raises(rb.DataError, match=rf"{name} cannot be written: there is no folder .*missing"):
            write(tmp_path / "missing" / name)
        with pytest.raises(rb.DataError, match=r"folder cannot be written: .*\n  try: another folder"):
            write(tmp_path / "folder")
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]


@pytest.mark.parametrize(
    ("writer", "name", "other"),
    [
        ("save", "run.mat", "run.nc; the other is written by run.to_mat"),
        ("to_mat", "run.NC", "run.mat"),
        ("to_csv", "run.csv", "run;"),
    ],
)
def test_names_of_other_kinds_of_files_are_refused(
    run: Run, tmp_path: Path, writer: str, name: str, other: str
) -> None:
    """A file name with the suffix of another format is refused with the right name."""
    with pytest.raises(rb.DataError, match=rf"{name}: a .* is written, not a {name[3:].lower()} file\n  try: {other}"):
        getattr(run, writer)(tmp_path / name)
    assert not any(tmp_path.iterdir())


def test_matlab_round_trip(any_run: Run, tmp_path: Path) -> None:
    """A MATLAB file has every variable unchanged, in structs with units."""
    from scipy.io import loadmat

    content = loadmat(any_run.to_mat(tmp_path / "run.mat"), simplify_cells=False)
    for group in any_run.groups:
        data, struct = getattr(any_run, group), content[group][0, 0]
        for name in data.variables:
            read, wanted = struct[name], data[name].values
            if wanted.dtype.kind == "U":
                assert [str(cell[0][0]) for cell in read] == wanted.tolist()
            else:
                np.testing.assert_array_equal(read, wanted[:, None] if wanted.ndim == 1 else wanted, err_msg=name)
            assert content["units"][0, 0][group][0, 0][name].size or wanted.dtype.kind == "U", name
            assert name.isidentifier()
            assert len(name) < 32
    info = content["info"][0, 0]
    assert info["case_toml"][0] == any_run.case_toml
    assert info["status"][0] == any_run.status
    assert info["seed"][0, 0] == 7


def _read(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return header, np.array([[float(cell) for cell in row] for row in rows]).reshape(-1, len(header))


def test_csv_keeps_every_digit(any_run: Run, tmp_path: Path) -> None:
    """The numbers in the CSV files are exactly those of the run, under headers with units."""
    files = any_run.to_csv(tmp_path / "new" / "folder")
    assert [path.name for path in files] == ["motion.csv", "energy.csv", "impacts.csv"]
    header, table = _read(files[0])
    point = any_run.arrays.points[0]
    assert header[0] == "time [s]"
    np.testing.assert_array_equal(table[:, 0], any_run.arrays.time)
    np.testing.assert_array_equal(
        table[:, header.index(f"displacement {point} [m]")], any_run.arrays.displacement[:, 0]
    )
    for k, ball in enumerate(any_run.arrays.balls):
        column = header.index(f"relative_velocity {ball} [m/s]")
        np.testing.assert_array_equal(table[:, column], any_run.arrays.relative_velocity[:, k])
    header, table = _read(files[1])
    np.testing.assert_array_equal(table[:, header.index("residual [J]")], any_run.ledger.residual)
    header, table = _read(files[2])
    log = any_run.arrays.impacts
    np.testing.assert_array_equal(table[:, header.index("peak_force [N]")], log.peak_force)
    np.testing.assert_array_equal(table[:, header.index("restitution")], log.restitution)
    np.testing.assert_array_equal(table[:, header.index("complete")], log.complete)


def test_csv_of_names_with_commas(run: Run, tmp_path: Path) -> None:
    """A point with a comma and quotes in its name has one column."""
    named = Run(run.arrays.replaced(points=('tip, "left"',)))
    header, _ = _read(named.to_csv(tmp_path)[0])
    assert 'displacement tip, "left" [m]' in header


def test_csv_needs_a_folder(run: Run, tmp_path: Path) -> None:
    """A file with the name of the output folder is an error and is not changed."""
    (tmp_path / "notes").write_text("mine")
    with pytest.raises(rb.DataError, match="notes is a file; "):
        run.to_csv(tmp_path / "notes")
    assert (tmp_path / "notes").read_text() == "mine"


def test_saving_through_a_link_writes_its_target(tmp_path: Path) -> None:
    """A run that is saved under the name of a symbolic link is written to the target of the link."""
    (tmp_path / "kept.nc").touch()
    (tmp_path / "latest.nc").symlink_to(tmp_path / "kept.nc")
    run = rb.simulate(rb.reference_case(duration=0.01))
    run.save(tmp_path / "latest.nc")
    assert (tmp_path / "latest.nc").is_symlink()
    assert rb.load(tmp_path / "kept.nc").arrays == run.arrays
