"""Views, background work and downloads of the browser application."""

import html
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image
from scipy.io import loadmat

import rattlebox as rb
from rattlebox.app import worker
from rattlebox.app.binary import decode, encode
from rattlebox.app.draft import template
from rattlebox.app.results import (
    FORMATS,
    MAP_FORMATS,
    download,
    download_map,
    inside,
    maps,
    new_name,
    runs,
    store_file,
    stored_map,
)
from rattlebox.app.runs import differences
from rattlebox.app.views import view_of_snapshots

SHORT_BOX = (
    template("box")
    .replace('duration = "1 s"', 'duration = "20 ms"')
    .replace("count = 200", "count = 8")
    .replace("snapshots = 200", "snapshots = 5")
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a 1-D run, a particle run and a map."""
    place = tmp_path_factory.mktemp("app")
    worker.run(lambda *_: None, template("steel_ball").replace("5 s", "0.2 s"), str(place), "run-001", True)
    worker.run(lambda *_: None, SHORT_BOX, str(place), "run-002", False)
    axes = {"damper.gap": ("0.2 mm", "0.8 mm", 3, False)}
    worker.sweep(
        lambda *_: None, template("steel_ball").replace("5 s", "0.2 s"), str(place), "map-001", axes, "rms", True
    )
    return place


def test_binary_round_trip():
    """Arrays and header come back; infinity, which JSON and charts lack, is NaN."""
    arrays, about = decode(encode({"a": [[1.0, 2.0]], "b": [np.inf, 1e300]}, title="µ"))
    assert about == {"title": "µ"}
    assert arrays["a"].tolist() == [[1.0, 2.0]]
    assert np.isnan(arrays["b"]).all()


def test_view_has_the_numbers_of_the_run(folder):
    """The curves of the page are those of the run."""
    text = template("steel_ball").replace("5 s", "0.2 s")
    arrays, about = decode(worker.live(lambda *_: None, text, str(folder), True))
    run = rb.load(folder / "run-001.nc")
    assert np.allclose(arrays["displacement mass"], 1e3 * run.motion.displacement.values[:, 0], atol=1e-6)
    assert np.allclose(arrays["work"][-1], 1e3 * run.energy.work.values[-1])
    assert about["impact_count"] == run.impacts.sizes["impact"] == arrays["impact time"].size
    assert abs(arrays["place"]).max() < 1.1 * about["gaps"][0]
    listed = {series["y"] for chart in about["charts"] for series in chart["series"]}
    assert (
        {"displacement mass", "bare displacement", "work", "normal_loss", "speed", "impact speed"}
        <= listed
        <= set(arrays)
    )


def test_view_of_particles(folder):
    """The frames hold all particles, inside the moving cavity."""
    arrays, about = decode(view_of_snapshots(folder / "run-002.vtkhdf"))
    assert arrays["position"].shape == (5, 8, 3)
    assert about["next"] == about["planned"] == 5
    inner = np.abs(arrays["position"] - arrays["shift"]) + arrays["radius"][:, None]
    assert (inner <= np.array(about["cavities"][0]["size"]) / 2 * (1 + 1e-4)).all()
    rest, _ = decode(view_of_snapshots(folder / "run-002.vtkhdf", 3))
    assert rest["position"].shape[0] == 2
    assert decode(view_of_snapshots(folder / "absent.vtkhdf"))[1]["next"] == 0


def test_particle_run_in_parts_has_the_same_bits(folder, tmp_path, monkeypatch):
    """A run that is stopped for intermediate views gives the bits of a run without stops."""
    seen = []
    monkeypatch.setattr(worker, "FIRST_LOOK", 0.02)
    monkeypatch.setattr(worker, "MOST_WAIT", 0.05)
    text = SHORT_BOX.replace('"20 ms"', '"60 ms"')
    worker.run(lambda what, *_: seen.append(what), text, str(tmp_path), "run-001", False)
    assert "view" in seen
    expected = rb.simulate(rb.Case.from_toml(text), snapshots=tmp_path / "x.vtkhdf", progress=False)
    assert rb.load(tmp_path / "run-001.nc") == expected
    assert not list(tmp_path.glob("*.checkpoint"))


def test_results_are_listed(folder):
    """Runs and maps are listed, and a new name is free."""
    assert sorted(runs(folder)) == ["run-001", "run-002"]
    assert maps(folder) == ["map-001"]
    assert new_name(folder, "run") == "run-003"


def run_script(content, place):
    """Run a downloaded script in an empty folder and return what it prints."""
    done = subprocess.run([sys.executable, "-c", content], cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(summary):
    """Return the lines of a summary but for the computing time."""
    return [line.strip() for line in summary.splitlines() if line.strip() and "computing time" not in line]


def test_downloads_of_a_run_are_opened(folder, tmp_path):
    """Each file of a run, opened by the program that it is for, has the numbers of the run."""
    run = rb.load(folder / "run-001.nc")
    displacement = run.motion.displacement.values[:, 0]
    files = {suffix: download(folder, "run-001", suffix) for suffix in FORMATS if suffix != "vtkhdf"}
    for suffix, content in files.items():
        (tmp_path / f"run.{suffix}").write_bytes(content)

    assert rb.load(tmp_path / "run.nc") == run
    with xr.open_dataset(tmp_path / "run.nc", group="motion") as motion:
        assert np.array_equal(motion.displacement.values[:, 0], displacement)
    with zipfile.ZipFile(tmp_path / "run.csv") as archive:
        rows = archive.read("run-001/motion.csv").decode().splitlines()
    column = rows[0].split(",").index("displacement mass [m]")
    assert np.allclose([float(row.split(",")[column]) for row in rows[1:]], displacement)
    assert np.array_equal(loadmat(tmp_path / "run.mat")["motion"]["displacement"].item().ravel(), displacement)
    assert rb.Case.from_file(tmp_path / "run.toml") == run.case
    with Image.open(tmp_path / "run.png") as figure:
        assert figure.width > 500
        assert len(figure.convert("RGB").getcolors(1 << 24)) > 10
    page = html.unescape((tmp_path / "run.html").read_text(encoding="utf-8"))
    assert f"{run.summary().values['impacts']:.0f}" in page
    assert not re.search(r"(src|href)=.https?://", page)
    assert numbers(run_script(files["py"].decode(), tmp_path)) == numbers(str(run.summary()))
    assert (tmp_path / "motion.png").exists()


def test_particles_are_downloaded(folder, tmp_path):
    """The snapshots for ParaView, and the case file of a run of particles, are those of the run."""
    (tmp_path / "run.vtkhdf").write_bytes(download(folder, "run-002", "vtkhdf"))
    assert len(rb.Snapshots(tmp_path / "run.vtkhdf")) == 5
    assert rb.Case.from_toml(download(folder, "run-002", "toml").decode()) == rb.load(folder / "run-002.nc").case


def test_studies_of_other_kinds_are_refused_with_their_commands(tmp_path):
    """Opening one as a map or as a run names its kind and a command that shows it: the map ended in a KeyError.

    The folders of the tests had sweeps only.
    """
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
        method=rb.Newton(),
        duration="1 s",
    )
    result = rb.lyapunov(case, cycles=(5, 5), pairs=1, store=tmp_path / "chaos.zarr", progress=False)
    with pytest.raises(rb.DataError, match="a study of the kind lyapunov") as raised:
        stored_map(tmp_path, "chaos")
    assert "rattlebox report chaos.zarr" in raised.value.suggestion
    result.to_netcdf(tmp_path / "chaos.nc", engine="h5netcdf")
    for suffix in ("csv", "html"):
        with pytest.raises(rb.DataError, match="holds the result of a study"):
            download(tmp_path, "chaos", suffix)


def test_downloads_of_a_map_are_opened(folder, tmp_path):
    """Each file of a map has the ratio to the case without damper that the page draws; the script computes the same."""
    study, drawn = stored_map(folder, "map-001")
    files = {suffix: download_map(folder, "map-001", suffix) for suffix in MAP_FORMATS}
    for suffix, content in files.items():
        (tmp_path / f"map.{suffix}").write_bytes(content)

    ratio = study[drawn].values
    bare = rb.sweep(study_case(study).model_copy(update={"dampers": ()}), {"seed": [0]}, "rms", progress=False)
    assert np.allclose(ratio, study.rms.values / bare.rms.item())
    table = np.genfromtxt(tmp_path / "map.csv", delimiter=",", names=True, deletechars="")
    assert np.allclose(table[drawn], ratio)
    with xr.open_dataset(tmp_path / "map.nc") as stored:
        assert np.array_equal(stored[drawn].values, ratio)
    with Image.open(tmp_path / "map.png") as figure:
        assert figure.width > 500
    assert "damper.gap" in (tmp_path / "map.html").read_text(encoding="utf-8")
    printed = run_script(files["py"].decode(), tmp_path).splitlines()
    assert np.allclose([float(line.split()[-1]) for line in printed[1:-1]], ratio, rtol=1e-5)
    assert (tmp_path / "map.png").exists()


def study_case(study):
    """Return the case of a study."""
    return rb.Case.from_toml(study.attrs["case"])


@pytest.mark.parametrize("name", ["../x", "", "a/b", "x" * 100, "run-001.nc/..", "run-999", "\x00"])
def test_other_names_are_refused(folder, name):
    """Only results in the folder can be downloaded."""
    with pytest.raises(rb.RattleboxError):
        inside(folder, name, ".nc")


def test_results_survive_the_page(folder):
    """The map of a page and its companion without damper are on disk when the task is done."""
    assert {path.name for path in Path(folder).glob("*.zarr")} == {"map-001.zarr", "map-001.bare.zarr"}


@pytest.mark.parametrize(
    "name",
    ["../x.csv", "/tmp/x.csv", "a/b.csv", ".x.csv", "x.toml", "x.nc", "x.csv.py", "x" * 99 + ".csv", "\x00.csv", ""],
)
def test_files_are_added_to_the_folder_only(folder, name):
    """A file of data needs a plain name, so that it is in the folder and replaces no result."""
    before = sorted(folder.iterdir())
    with pytest.raises(rb.DataError, match="not the name"):
        store_file(folder, name, b"1")
    assert sorted(folder.iterdir()) == before


def test_a_number_of_a_long_list_is_a_difference():
    """Cases that differ in one number of a long list are not called equal."""
    start = [0.0, 0.1, 0.2, 0.3, 0.4]
    balls = [rb.Sphere(radius="5 mm", material="steel")] * len(start)
    contact = rb.Tsuji(restitution=0.6)

    def run(first):
        damper = rb.ImpactDamper(balls=balls, gap="9 mm", contact=contact, velocity=[first, *start[1:]])
        return rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="1 ms"))

    assert differences({"a": run(0.0), "b": run(0.0)}) == "The case files are equal."
    rows = [line.split() for line in differences({"a": run(0.0), "b": run(0.5)}).splitlines()]
    assert [row[0] for row in rows[2:]] == ["dampers[0].velocity"]


def test_part_of_a_file_is_not_left(tmp_path, monkeypatch):
    """A record that does not fit on the disk is removed: a part of it would look like a short record."""

    class Full:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def write(self, _):
            raise OSError(28, "No space left on device")

    def opened(path, mode):
        path.touch()
        return Full()

    monkeypatch.setattr(Path, "open", opened)
    with pytest.raises(OSError, match="No space"):
        store_file(tmp_path, "push.csv", b"0, 1")
    assert not list(tmp_path.iterdir())
