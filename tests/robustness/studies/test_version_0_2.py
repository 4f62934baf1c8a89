"""Results of 0.2.0: they are read with the same numbers; what it began is refused with advice that names it.

`version_0_2.zip` was written by 0.2.0 with `write.py`, which is in it: a run, a run with particles, a sweep and a design,
some of them also unfinished, and their numbers.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.command import rattlebox

import rattlebox as rb

ARCHIVE = Path(__file__).with_name("version_0_2.zip")
GAP = {"damper.gap": ("0.2 mm", "2 mm")}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder with the files of 0.2.0."""
    with zipfile.ZipFile(ARCHIVE) as archive:
        archive.extractall(tmp_path)
    return tmp_path


def numbers(folder: Path) -> Any:
    """Return the numbers that 0.2.0 computed."""
    return json.loads((folder / "numbers.json").read_text())


@pytest.mark.parametrize("name", ["run", "bed"])
def test_a_run_is_read(folder: Path, name: str) -> None:
    """A saved run has its motion, summary and report; no test had ever opened a file of an earlier version."""
    run = rb.load(folder / f"{name}.nc")
    assert float(abs(run.motion.displacement).max()) == numbers(folder)[name]
    assert run.provenance.version == "0.2.0"
    assert "finished" in str(run.summary())
    rb.write_report(run, folder / "report.html")


@pytest.mark.parametrize(("store", "name"), [("sweep.zarr", "sweep"), ("design.zarr", "design")])
def test_a_study_is_read(folder: Path, store: str, name: str) -> None:
    """A finished study has its values, is shown and reported."""
    study = rb.open_study(folder / store)
    np.testing.assert_array_equal(study.peak.values, numbers(folder)[name])
    rb.write_report(study, folder / "report.html")
    shown = rattlebox("show", folder / store)
    assert shown.returncode == 0
    assert "0.2.0" not in shown.stdout


def test_an_unfinished_study_is_read(folder: Path) -> None:
    """An unfinished sweep has its two finished variants, and NaN for the third."""
    peak = rb.open_study(folder / "stopped.zarr").peak.values
    assert np.isfinite(peak).tolist() == [True, True, False]


@pytest.mark.parametrize("store", ["stopped.zarr", "stopped_design.zarr"])
def test_show_names_the_version_that_resumes(folder: Path, store: str) -> None:
    """The advice to repeat the command of an unfinished study names 0.2.0; it ended in a refusal without the version."""
    shown = rattlebox("show", folder / store)
    assert "repeat the command that started it with Rattlebox 0.2.0 to resume" in shown.stdout


def test_show_names_the_version_that_resumes_a_run(folder: Path) -> None:
    """The advice to repeat the command of an unfinished run names 0.2.0."""
    (folder / "out").mkdir()
    (folder / "run.checkpoint").rename(folder / "out" / "run.checkpoint")
    shown = rattlebox("show", folder / "out")
    assert "Repeat the command that started the run with Rattlebox 0.2.0 to resume it." in shown.stdout


@pytest.mark.parametrize("store", ["sweep.zarr", "stopped.zarr"])
def test_a_sweep_is_not_resumed(folder: Path, store: str) -> None:
    """A sweep of 0.2.0 is neither resumed nor changed; both parts of the advice can be followed."""
    case = rb.Case.from_file(folder / ("rig.toml" if store == "sweep.zarr" else "beads.toml"))
    axes: Any = {"damper.gap": ["0.3 mm", "0.6 mm", "0.9 mm"], "load.amplitude": ["20 N", "40 N"]}
    axes = axes if store == "sweep.zarr" else {"damper.friction": [0.1, 0.2, 0.3]}
    before = {path: path.read_bytes() for path in (folder / store).rglob("c/*") if path.is_file()}
    with pytest.raises(rb.StoreError) as refused:
        rb.sweep(case, axes, "peak", store=folder / store, progress=False)
    assert f'version: "0.2.0" there, "{rb.__version__}" here' in str(refused.value)
    advice = "another folder, or the same command with Rattlebox 0.2.0; rb.open_study reads this one"
    assert refused.value.suggestion == advice
    assert {path: path.read_bytes() for path in before} == before
    assert rb.open_study(folder / store).sizes == rb.sweep(case, axes, "peak", progress=False).sizes


def test_a_design_is_not_resumed(folder: Path) -> None:
    """A design of 0.2.0 is refused with the version that resumes it; the message named only the field."""
    case = rb.Case.from_file(folder / "rig.toml")
    with pytest.raises(rb.StoreError, match=r'version: "0\.2\.0" there') as refused:
        rb.design(case, GAP, {"peak": "min"}, trials=6, store=folder / "stopped_design.zarr", progress=False)
    assert refused.value.suggestion == "another folder, or the same command with Rattlebox 0.2.0"


def test_a_checkpoint_is_not_resumed(folder: Path) -> None:
    """A checkpoint of 0.2.0 is refused with the version that resumes it."""
    case = rb.Case.from_file(folder / "beads.toml")
    with pytest.raises(rb.DataError, match=r"0\.2\.0") as refused:
        rb.simulate(case, checkpoint=folder / "run.checkpoint", progress=False)
    assert refused.value.suggestion == "another file, or the same command with Rattlebox 0.2.0"


def test_a_packed_case_has_the_same_layout_or_another_version(folder: Path) -> None:
    """The number of the format rises with its layout: a case packed by 0.2.0 would else be read as other numbers."""
    assert rattlebox("pack", folder / "rig.toml", "-o", folder / "now.rattlebox").returncode == 0
    then, now = ((folder / f"{name}.rattlebox").read_bytes() for name in ("rig", "now"))
    if then[8:16] == now[8:16]:
        np.testing.assert_allclose(np.frombuffer(now[40:]), np.frombuffer(then[40:]), rtol=1e-12)
