"""Views, background work and downloads of the browser application."""

import zipfile
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.app import worker
from rattlebox.app.binary import decode, encode
from rattlebox.app.draft import template
from rattlebox.app.results import download, download_map, inside, maps, new_name, runs
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


@pytest.mark.parametrize("suffix", ["nc", "csv", "mat", "toml", "py", "png", "html"])
def test_downloads_of_a_run(folder, suffix):
    """Each format has the expected content."""
    content = download(folder, "run-001", suffix)
    if suffix == "csv":
        assert "run-001/motion.csv" in zipfile.ZipFile(BytesIO(content)).namelist()
    elif suffix == "toml":
        assert rb.Case.from_toml(content.decode()) == rb.load(folder / "run-001.nc").case
    elif suffix == "py":
        names = {}
        exec(content.decode().partition("run = ")[0], names)
        assert names["case"] == rb.load(folder / "run-001.nc").case
    else:
        assert content[:4] in (b"\x89HDF", b"MATL", b"\x89PNG") or content.startswith(b"<!doctype html>")


@pytest.mark.parametrize("suffix", ["nc", "csv", "png", "html"])
def test_downloads_of_a_map(folder, suffix):
    """Tables and figures of a map have its values."""
    content = download_map(folder, "map-001", suffix, "")
    known = (b"\x89HDF", b"\x89PNG", b"damper.gap", b"<!doctype html>")
    assert content.startswith(known)


@pytest.mark.parametrize("name", ["../x", "", "a/b", "x" * 100, "run-001.nc/..", "run-999", "\x00"])
def test_other_names_are_refused(folder, name):
    """Only results in the folder can be downloaded."""
    with pytest.raises(rb.RattleboxError):
        inside(folder, name, ".nc")


def test_results_survive_the_page(folder):
    """The map of a page and its companion without damper are on disk when the task is done."""
    assert {path.name for path in Path(folder).glob("*.zarr")} == {"map-001.zarr", "map-001.bare.zarr"}
