"""A flipped bit in a file of results is detected on reading, or does not change the content."""

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.checkpoint import Checkpoint

FILES = ("run.nc", "run.vtkhdf", "run.checkpoint")


def case() -> rb.Case:
    """Return a short run of five particles with snapshots."""
    return rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1e4, velocity=0.5),
        dampers=rb.ParticleDamper(
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            particles=rb.Particles(diameter="4 mm", material="steel", count=5),
            contact=rb.Tsuji(restitution=0.8),
            packing=rb.Lattice(),
            gravity=(0, 0, 0),
        ),
        duration=2e-3,
        output=rb.Output(rate=5e3, snapshots=4),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the files of a run."""
    folder = tmp_path_factory.mktemp("run")
    run = rb.simulate(case(), checkpoint=folder / "run.checkpoint", snapshots=folder / "run.vtkhdf")
    run.save(folder / "run.nc")
    return folder


def bits(value: Any) -> Any:
    """Return the same content with arrays as bytes, so that NaN equals NaN."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Mapping):
        return {name: bits(part) for name, part in value.items()}
    if isinstance(value, (tuple, list)):
        return [bits(part) for part in value]
    if type(value).__module__.startswith("rattlebox"):
        return bits(
            {name: getattr(value, name) for name in getattr(value, "__dict__", getattr(value, "__slots__", ()))}
        )
    assert isinstance(value, (str, int, float, type(None))), type(value)
    return repr(value)


def content(path: Path) -> Any:
    """Return everything that a reader returns for a file, as bytes."""
    if path.suffix == ".nc":
        return bits(vars(rb.load(path)))
    if path.suffix == ".vtkhdf":
        snapshots = rb.Snapshots(path)
        frames = [{name: np.asarray(value).tobytes() for name, value in vars(frame).items()} for frame in snapshots]
        return snapshots.case_toml, snapshots.numbers, snapshots.planned.tobytes(), frames
    checkpoint = Checkpoint(path, case()).read()
    assert checkpoint is not None
    names = [name for name in dir(checkpoint.records) if not name.startswith("_")]
    records = {name: value for name in names if isinstance(value := getattr(checkpoint.records, name), np.ndarray)}
    assert records
    arrays = {**records, "state": checkpoint.state, **{str(k): array for k, array in enumerate(checkpoint.positions)}}
    return (
        checkpoint.numbers,
        checkpoint.time,
        checkpoint.seconds,
        {name: array.tobytes() for name, array in arrays.items()},
    )


def detected(path: Path, changed: bytes, exact: Any) -> bool:
    """Return whether a changed file is refused with its name; if not, its content must be unchanged."""
    path.write_bytes(changed)
    try:
        result = content(path)
    except rb.DataError as error:
        message = str(error)
    else:
        assert result == exact
        return False
    assert path.name in message
    return True


def flipped(whole: bytes, place: int, bit: int) -> bytes:
    """Return bytes with one bit flipped."""
    return whole[:place] + bytes([whole[place] ^ 1 << bit]) + whole[place + 1 :]


@pytest.mark.parametrize("flips", [50, pytest.param(400, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", FILES)
def test_a_flipped_bit_is_detected_or_harmless(name: str, flips: int, folder: Path, tmp_path: Path) -> None:
    """The flipped bits are spread over the structure, attributes, short arrays and numbers of a file."""
    whole, path = (folder / name).read_bytes(), tmp_path / name
    exact = content(folder / name)
    generator = np.random.default_rng(11)
    used = np.flatnonzero(np.frombuffer(whole, "u1"))  # most zeros of an HDF5 file are unused
    places = [*generator.integers(0, len(whole), flips // 2), *generator.choice(used, flips)]
    refused = sum(detected(path, flipped(whole, place, int(generator.integers(8))), exact) for place in places)
    assert refused > flips // 2


def locate_values(path: Path) -> Iterator[tuple[str, int, int]]:
    """Yield name, place in the file and size of the values of each dataset."""
    result: list[tuple[str, int, int]] = []
    with h5py.File(path) as file:

        def add(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.id.get_offset() is not None:
                result.append((name, item.id.get_offset(), item.id.get_storage_size()))

        file.visititems(add)
    yield from result


def test_a_flipped_bit_of_any_dataset_of_snapshots_is_detected(folder: Path, tmp_path: Path) -> None:
    """The values of every dataset are protected, also of short ones and of those that only ParaView reads."""
    whole, path = (folder / "run.vtkhdf").read_bytes(), tmp_path / "run.vtkhdf"
    exact, generator = content(folder / "run.vtkhdf"), np.random.default_rng(5)
    names = set()
    for name, start, size in locate_values(folder / "run.vtkhdf"):
        for place in start + generator.integers(0, size, 3):
            assert detected(path, flipped(whole, int(place), int(generator.integers(8))), exact), name
        names.add(name)
    assert {"VTKHDF/Points", "VTKHDF/NumberOfPoints", "VTKHDF/Steps/Values", "digests"} <= names


@pytest.mark.slow
def test_a_flipped_bit_of_any_array_or_attribute_of_a_run_is_detected(folder: Path, tmp_path: Path) -> None:
    """Every variable and attribute of a run is protected, also short ones."""
    path = tmp_path / "run.nc"
    names: list[str] = []
    with h5py.File(folder / "run.nc") as file:
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    assert {"case", "motion/time", "energy/kinetic_energy"} <= set(names)
    for number, name in enumerate(names):
        for part in ("values", "units" if number % 2 else "long_name"):
            path.write_bytes((folder / "run.nc").read_bytes())
            with h5py.File(path, "r+") as file:
                item = file[name]
                if part == "values":
                    values = np.atleast_1d(item[()])
                    values.view("u1").reshape(-1)[0] ^= 1
                    item[...] = values.reshape(item.shape)
                elif part in item.attrs:
                    item.attrs.modify(part, np.bytes_(b"x" + bytes(item.attrs[part])[1:]))
                else:
                    continue
            with pytest.raises(rb.DataError, match=r"run\.nc is damaged: the group '.*'"):
                rb.load(path)


def test_the_damaged_block_is_named(folder: Path, tmp_path: Path) -> None:
    """The message names the damaged snapshot or array; other snapshots can be read."""
    path = tmp_path / "run.vtkhdf"
    path.write_bytes((folder / "run.vtkhdf").read_bytes())
    with h5py.File(path, "r+") as file:
        second = file["VTKHDF/Steps/PointDataOffsets/contact_force"][1]
        file["VTKHDF/PointData/contact_force"][second + 2] += 1.0
    snapshots = rb.Snapshots(path)
    assert len(snapshots) == 4
    assert np.isfinite(snapshots[0].position).all()
    with pytest.raises(rb.DataError, match=r"run\.vtkhdf is damaged: snapshot 1 has changed\n  try: a copy"):
        snapshots[1]
    with h5py.File(path, "r+") as file:
        file["VTKHDF/PointData/mass"][0] *= 2
    with pytest.raises(rb.DataError, match=r"run\.vtkhdf is damaged: its description"):
        rb.Snapshots(path)
    run = tmp_path / "run.nc"
    run.write_bytes((folder / "run.nc").read_bytes())
    with h5py.File(run, "r+") as file:
        file["energy/kinetic_energy"][0] += 1e-12
    with pytest.raises(rb.DataError, match=r"run\.nc is damaged: the group 'energy'.*\n  try: a copy"):
        rb.load(run)
    state = tmp_path / "run.checkpoint"
    with np.load(folder / "run.checkpoint") as there:
        arrays = dict(there)
    arrays["position.0"][0, 0] += 1e-9
    with state.open("wb") as file:
        np.savez(file, **arrays)
    with pytest.raises(
        rb.DataError, match=r"run\.checkpoint is not an intact checkpoint: the block 'position\.0' is damaged"
    ):
        Checkpoint(state, case()).read()


def _format_in_hdf5(path: Path, number: int) -> None:
    with h5py.File(path, "r+") as file:
        file.attrs["rattlebox_format"] = np.int32(number)


def _format_of_checkpoint(path: Path, number: int) -> None:
    with np.load(path) as there:
        arrays = dict(there)
    about = json.loads(arrays["about"].tobytes()) | {"format": number}
    arrays["about"] = np.frombuffer(json.dumps(about).encode(), np.uint8)
    with path.open("wb") as file:
        np.savez(file, **arrays)


@pytest.mark.parametrize(
    ("name", "change"),
    [("run.nc", _format_in_hdf5), ("run.vtkhdf", _format_in_hdf5), ("run.checkpoint", _format_of_checkpoint)],
    ids=FILES,
)
@pytest.mark.parametrize("number", [0, 99])
def test_another_format_is_refused_with_both_numbers(
    name: str, change: Callable[[Path, int], None], number: int, folder: Path, tmp_path: Path
) -> None:
    """Files of an older and of a later format are refused with the format of the file and that of this version."""
    path = tmp_path / name
    path.write_bytes((folder / name).read_bytes())
    change(path, number)
    with pytest.raises(
        rb.DataError, match=rf"{name} has format {number}, and this version .* reads format \d+\n  try: "
    ):
        content(path)
