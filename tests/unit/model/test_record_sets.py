"""Sets of records: names, units and steps of each file, and their use as an axis of a study."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.study_file import study_from_toml

PEAKS = {"garnet": 2.5, "opal": 0.3 * 9.80665, "zircon": 1.25}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with three records in gal, g and mm/s^2, of other steps and lengths."""
    quakes = tmp_path / "quakes"
    quakes.mkdir()
    t = np.arange(301) * 0.01
    wave = np.sin(7 * t) * np.exp(-t)
    shape = wave / np.abs(wave).max()
    (quakes / "garnet.csv").write_text(
        "time (s), acceleration (gal)\n" + "".join(f"{a:.2f}, {250 * b:.17g}\n" for a, b in zip(t, shape, strict=True))
    )
    values = "".join(f"{0.3 * b:.9E}\n" for b in shape[:251])
    (quakes / "opal.at2").write_text(
        "PEER STRONG MOTION DATABASE RECORD\nOPAL HILL\nACCELERATION TIME SERIES IN UNITS OF G\n"
        f"NPTS=  251, DT= .02000 SEC\n{values}"
    )
    (quakes / "zircon.txt").write_text(
        "time (ms)\tacceleration (mm/s^2)\n"
        + "".join(f"{1000 * a:.0f}\t{1250 * b:.17g}\n" for a, b in zip(t, shape, strict=True))
    )
    return quakes


@pytest.fixture
def case() -> rb.Case:
    """Return a case with a base that does not move."""
    return rb.Case(
        structure=rb.SDOF(mass="3 kg", frequency="1.7 Hz", damping_ratio=0.04),
        base=rb.Record(times=[0, 9], values=[0, 0], unit="m/s^2"),
        duration="2.5 s",
    )


def test_folder(folder: Path) -> None:
    """Records of a folder had to be read one by one, with names and units kept by hand."""
    (folder / ".hidden").write_text("nothing")
    records = rb.record_set(folder, direction="x")
    assert list(records) == list(PEAKS)
    assert {name: record.peak for name, record in records.items()} == pytest.approx(PEAKS, rel=1e-6)
    assert records.durations == pytest.approx((3.0, 5.0, 3.0))
    assert [record.name for record in records.values()] == list(PEAKS)
    assert records["opal"].direction == rb.record_set([folder / "opal.at2"], direction="x")["opal"].direction
    assert "3 records: garnet, opal, zircon" in repr(records)


def test_patterns_lists_and_mappings(folder: Path) -> None:
    """Patterns, lists with names, and mappings give the same records as the folder, in their own order."""
    every = rb.record_set(str(folder))
    assert list(rb.record_set(f"{folder}/*.[ct]*")) == ["garnet", "zircon"]
    listed = rb.record_set([folder / "zircon.txt", folder / "opal.at2"], names=["north", "south"])
    assert list(listed) == ["north", "south"]
    assert np.array_equal(listed["south"].values, every["opal"].values)
    mapped = rb.record_set({"a": folder / "opal.at2", "b": every["zircon"]})
    assert [record.name for record in mapped.values()] == ["a", "b"]
    assert rb.record_set(mapped) is mapped


def test_equal_stems(folder: Path) -> None:
    """Files that differ in their ending only, such as components of a station, have names with it."""
    (folder / "opal.csv").write_text((folder / "garnet.csv").read_text())
    assert list(rb.record_set(folder)) == ["garnet.csv", "opal.at2", "opal.csv", "zircon.txt"]


@pytest.mark.parametrize(
    ("files", "options", "message"),
    [
        ("*.none", {}, r"no file matches .*none\n  try: the pattern of existing"),
        ("absent", {}, r"there is no folder and no file .*absent\n  try: a pattern"),
        ([], {}, "the list has no files"),
        ({}, {}, "a set of records needs at least one record"),
        (["opal.at2"], {"names": ["a", "b"]}, r"2 names for 1 file: opal.at2\n  try: one name for each file"),
        (["opal.at2", "zircon.txt"], {"names": ["a", "a"]}, "'a' is the name of two records"),
        (["opal.at2", "opal.at2"], {}, r"'opal.at2' is the name of two records\n  try: names, one for each file"),
        ({"a": "opal.at2"}, {"names": ["b"]}, "a mapping of files has names already"),
        ("*.at2", {"unit": "gal"}, "the file states another unit above the column"),
        ("*.at2", {"colums": 1}, "there is no such field"),
        (3, {}, "neither a folder, a pattern nor a list"),
    ],
)
def test_bad_sets(folder: Path, monkeypatch: pytest.MonkeyPatch, files: object, options: dict, message: str) -> None:
    """Sets that cannot be read name the file or the pattern, and what to try."""
    monkeypatch.chdir(folder)
    with pytest.raises(rb.RattleboxError, match=message):
        rb.record_set(files, **options)


def test_other_files_of_a_folder(folder: Path) -> None:
    """A file of a folder that is no record is an error with its name, rather than left out."""
    (folder / "notes.txt").write_text("measured in May\n")
    with pytest.raises(rb.RattleboxError, match=r"notes\.txt"):
        rb.record_set(folder)


def test_axis_of_records(folder: Path, case: rb.Case) -> None:
    """Labels of an axis of records were their fields in brackets; now they are names, and each variant is its own run."""
    records = rb.record_set(folder)
    result = rb.sweep(case, {"base": records, "base.scale": [1, 2]}, ["peak"], progress=False)
    assert result.peak.dims == ("base", "base.scale")
    assert result["base"].values.tolist() == list(PEAKS)
    for name, record in records.items():
        run = rb.simulate(case.replaced({"base": record}))
        at = result.peak.sel(base=name)
        own = rb.sweep(run.case, {"base.scale": [1, 2]}, ["peak"], progress=False).peak
        assert at.values.tolist() == own.values.tolist()
        assert float(at[1]) == pytest.approx(2 * float(at[0]), rel=1e-9)


def test_axis_of_loads(folder: Path, case: rb.Case) -> None:
    """Records may vary as the only load, and with their lengths, along an axis with a name."""
    t = np.linspace(0, 4, 401)
    pushes = rb.RecordSet(
        {f"push {k}": rb.Record(times=t[: 200 + k], values=k * np.sin(t[: 200 + k]), unit="N") for k in (1, 2)}
    )
    case = case.replaced({"base": None, "load": pushes["push 1"], "duration": 1.5})
    result = rb.sweep(case, {"push": {"load": pushes, "duration": pushes.durations}}, ["peak"], progress=False)
    assert result["load"].values.tolist() == ["push 1", "push 2"]
    assert result["duration"].values.tolist() == list(pushes.durations)


def test_records_of_a_study_file(folder: Path, case: rb.Case, tmp_path: Path) -> None:
    """A study file names its records relative to its folder; the result is that of Python, also from a store."""
    content = """
        measure = ["peak"]
        [case]
        duration = "2.5 s"
        [case.structure]
        kind = "sdof"
        mass = "3 kg"
        frequency = "1.7 Hz"
        damping_ratio = 0.04
        [case.base]
        kind = "record"
        times = [0, 9]
        values = [0, 0]
        unit = "m/s^2"
        [axes]
        base = { records = FILES }
        "base.scale" = [1, 2]
    """
    expected = rb.sweep(case, {"base": rb.record_set(folder), "base.scale": [1, 2]}, ["peak"], progress=False)
    for files in ('"quakes"', '"quakes/*"', '["quakes/garnet.csv", "quakes/opal.at2", "quakes/zircon.txt"]'):
        study = study_from_toml(content.replace("FILES", files), folder=tmp_path)
        assert study.run(progress=False).equals(expected)
    study = study_from_toml(content.replace("FILES", '{ first = "quakes/opal.at2" }, direction = "x"'), folder=tmp_path)
    assert study.run(progress=False)["base"].values.tolist() == ["first"]
    stored = study.run(store=tmp_path / "study.zarr", progress=False)
    assert study.run(store=tmp_path / "study.zarr", progress=False).equals(stored)
    assert rb.open_study(tmp_path / "study.zarr").peak.equals(stored.peak)
    linked = content.split("[axes]")[0] + '[axes.quake]\nbase = { records = "quakes" }\n"base.scale" = [1, 2, 3]'
    assert study_from_toml(linked, folder=tmp_path).run(progress=False).peak.dims == ("quake",)


@pytest.mark.parametrize(
    ("files", "message"), [('"other"', "there is no folder and no file .*other"), ("3", "records = 3 are no files")]
)
def test_bad_records_of_a_study_file(files: str, message: str) -> None:
    """Records that are not there are errors of the study file."""
    with pytest.raises(rb.CaseError, match=message):
        study_from_toml(f"[axes]\nbase = {{ records = {files} }}\n")


def test_assumed_units_of_an_axis(folder: Path, case: rb.Case) -> None:
    """The unit that is assumed for a record of an axis is a warning, as for one of a case."""
    (folder / "quartz.txt").write_text("".join(f"{0.5 * k} {k % 3}\n" for k in range(9)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rb.sweep(case, {"base": rb.record_set(folder)}, ["peak"], progress=False)
    assert any("quartz.txt states no unit; m/s^2 is assumed" in str(each.message) for each in caught)


def test_spectral_acceleration_of_a_harmonic() -> None:
    """The steady response to a long harmonic record is that of the closed form, at and off resonance, for any damping."""
    time = np.arange(12_001) * 0.01
    values = 1.7 * np.sin(2 * np.pi * 1.3 * time)
    records = rb.RecordSet({"wave": rb.Record(dt="0.01 s", values=values, unit="m/s^2")})
    straight = np.sinc(1.3 * 0.01) ** 2  # of the lines between the samples
    for period, damping in ((1 / 1.3, 0.05), (1 / 1.3, 0.2), (0.5, 0.05), (0.2, 0.1)):
        own, driving = 2 * np.pi / period, 2 * np.pi * 1.3
        steady = 1.7 * straight * own**2 / abs(own**2 - driving**2 + 2j * damping * own * driving)
        found = records.spectral_accelerations(period, damping)["wave"]
        # Where the start from rest beats with the steady motion, the peak is that of an independent integration.
        if period != 1 / 1.3:
            from scipy.signal import lsim

            fine = np.linspace(0, 20, 200_001)
            system = ([-1.0], [1, 2 * damping * own, own**2])
            _, relative, _ = lsim(system, np.interp(fine, time, values), fine)
            assert found == pytest.approx(own**2 * np.abs(relative).max(), rel=1e-4)
            assert found >= steady * (1 - 1e-4)
        else:
            assert found == pytest.approx(steady, rel=2e-4)
    assert records.spectral_accelerations(0)["wave"] == np.abs(values).max()


def test_scaled_records_have_the_intensity(folder: Path, case: rb.Case) -> None:
    """With intensity, an axis of scales is the spectral acceleration; records had to be scaled by hand before."""
    g = 9.80665
    scaled = rb.record_set(folder, intensity=("1 g", "0.6 s"), direction=None)
    plain = rb.record_set(folder)
    assert list(scaled) == list(plain) and scaled.durations == plain.durations
    assert list(scaled.spectral_accelerations("0.6 s").values()) == pytest.approx([g] * 3, rel=1e-12)
    assert all(record.file is None and record.scale == 1 for record in scaled.values())
    # A scale of a record has no effect on the result.
    stronger = rb.record_set(folder, scale=3).scaled_to("1 g", "0.6 s")
    for name, record in stronger.items():
        assert record.values == pytest.approx(scaled[name].values, rel=1e-12)
    # The oscillator of the definition, as a case: the axis is its acceleration in g.
    mass = rb.SDOF(mass="1 kg", frequency=1 / 0.6, damping_ratio=0.05)
    still = case.model_copy(update={"structure": mass, "output": rb.Output(rate="1 kHz")})
    study = rb.sweep(still, {"base": scaled, "base.scale": [0.2, 0.5]}, ["peak"], samples=4001, progress=False)
    found = study.peak.values * (2 * np.pi / 0.6) ** 2 / g
    assert found == pytest.approx(np.array([[0.2, 0.5]] * 3), rel=1e-3)
    assert study["base"].values.tolist() == list(plain)
    assert {round(r.peak, 9) for r in rb.record_set(folder, intensity=(2.0, 0)).values()} == {2.0}


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        ([0, 0, 0, 0], {"period": "1 s"}, "has no acceleration"),
        ([0, 1, 0, 0], {"period": "0.1 s"}, "too short for the record"),
        ([0, 1, 0, 0], {"period": "-1 s"}, "must be at least 0"),
        ([0, 1, 0, 0], {"period": "1 s", "acceleration": "0 g"}, "must be greater than zero"),
        ([0, 1, 0, 0], {"period": "1 s", "damping_ratio": 1.0}, "below 1"),
        ([0, 1, 0, 0], {"period": "1 s", "unit": "N"}, "not an acceleration"),
        ([0, 1, 0, 0], {"period": "1 s", "times": [0, 0.1, 0.5, 0.6]}, "steps of the record 'a' must be equal"),
    ],
)
def test_records_that_cannot_be_scaled(values: list[float], options: dict, message: str) -> None:
    """Records without motion, of a force, in unequal steps, or too coarse for the period raise."""
    own = {"acceleration": "1 g", **options}
    times = {"times": own.pop("times")} if "times" in own else {"dt": "0.1 s"}
    records = rb.RecordSet({"a": rb.Record(values=values, unit=own.pop("unit", "m/s^2"), **times)})
    with pytest.raises(rb.CaseError, match=message):
        records.scaled_to(**own)


def test_intensity_in_a_study_file(folder: Path) -> None:
    """A study file scales a set of records by the argument of the same name."""
    text = (
        'kind = "sweep"\nmeasure = "peak"\n[axes]\n"base.scale" = [0.5]\n'
        'base = { records = "quakes/*.csv", intensity = ["1 g", "0.5 s"] }\n'
        '[case]\nduration = "2 s"\n[case.structure]\nkind = "sdof"\nmass = "1 kg"\nfrequency = "2 Hz"\n'
        "damping_ratio = 0.05\n"
        '[case.base]\nkind = "record"\ntimes = [0, 9]\nvalues = [0, 0]\nunit = "m/s^2"\n'
    )
    study = study_from_toml(text, folder=folder.parent)
    found = float(study.run().peak.values.ravel()[0]) * (2 * np.pi * 2) ** 2 / 9.80665
    assert found == pytest.approx(0.5, rel=2e-3)
    with pytest.raises(rb.CaseError, match="not a spectral acceleration and a period"):
        study_from_toml(text.replace('["1 g", "0.5 s"]', '"1 g"'), folder=folder.parent)
