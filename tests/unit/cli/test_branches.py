"""Branches of periodic motions on the command line: study files, files of branches, stops, reports."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support.waiting import wait_for

import rattlebox as rb
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.run.stored import partial_file
from rattlebox.studies.study_file import read_study

from .conftest import RunCli

CASE = """\
duration = "4 s"
[structure]
kind = "sdof"
mass = "2 kg"
frequency = "20 Hz"
damping_ratio = 0.012
[load]
kind = "harmonic"
amplitude = "6 N"
frequency = "20.7 Hz"
[damper]
gap = "1.2 mm"
ball = { radius = "18 mm", material = "steel" }
contact = { kind = "tsuji", restitution = 0.62 }
[method]
kind = "newton"
"""
STUDY = """\
kind = "continue_orbit"
axis = "load.frequency"
limits = ["19.4 Hz", "21.6 Hz"]
step = 0.02
[case]
file = "case.toml"
"""


@pytest.fixture(autouse=True)
def files(run_cli: RunCli) -> None:
    """Write a case and a study file to the current folder."""
    Path("case.toml").write_text(CASE)
    Path("branch.toml").write_text(STUDY)


def specials(data: object) -> list[tuple[str, float]]:
    """Return the special points of a branch in the order of the parameter."""
    points = rb.Branch(data).specials
    return sorted(((point.kind, point.value) for point in points), key=lambda each: each[1])


@pytest.mark.parametrize("stops", [(51,), pytest.param((1, 7, 50, 60, 75, -1), marks=pytest.mark.slow)])
def test_a_branch_that_was_stopped_has_the_same_bits(stops: tuple[int, ...], run_cli: RunCli) -> None:
    """A study that is stopped after any number of points, on either side, finishes with the bits of one without a stop.

    Files of branches were resumed in Python at two places only, where special points were compared; steps began anew,
    and the reason why a finished side ended was lost.
    """
    seen: list[int] = []
    whole = read_study("branch.toml").run(progress=lambda done, _: seen.append(done))
    assert specials(whole) and seen[-1] > 76
    for stop in (each if each > 0 else seen[-1] + each for each in stops):
        store = f"stop-{stop}.zarr"

        def progress(done: int, total: int, stop: int = stop) -> bool:
            return done <= stop

        with pytest.raises(Stopped, match="resumes from there"):
            read_study("branch.toml").run(store=store, progress=progress)
        code, out, errors = run_cli("show", store)
        assert (code, errors) == (0, "") and "in progress" in out and "not finished" in out
        found = read_study("branch.toml").run(store=store, progress=False)
        assert found.equals(whole)
        assert found.attrs["ended"] == whole.attrs["ended"]
        assert not partial_file(store).exists()


def test_damaged_points_count_as_not_computed(run_cli: RunCli) -> None:
    """A damaged file of the points so far is named when it is shown, and the command of the study begins again."""
    with pytest.raises(Stopped):
        read_study("branch.toml").run(store="branch.zarr", progress=lambda done, _: done < 9)
    content = partial_file("branch.zarr").read_bytes()
    partial_file("branch.zarr").write_bytes(content[: len(content) // 2])
    code, _, errors = run_cli("show", "branch.zarr")
    assert code == 2 and "so_far.nc" in errors and "begins again" in errors
    assert run_cli("sweep", "branch.toml")[0] == 0 and run_cli("show", "branch.zarr")[0] == 0


@pytest.mark.slow
def test_a_killed_branch_resumes(run_cli: RunCli) -> None:
    """After kill -9 the same command continues from the stored points; meanwhile they can be shown, drawn and reported."""
    Path("branch.toml").write_text(STUDY.replace("step = 0.02", "step = 0.002"))
    command = [sys.executable, "-m", "rattlebox.cli", "sweep", "branch.toml", "-o", "branch.zarr"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wait_for(partial_file("branch.zarr").is_file)
    process.kill()
    process.wait()
    before = rb.open_study("branch.zarr").sizes["point"]
    code, out, _ = run_cli("show", "branch.zarr")
    assert code == 0 and "in progress" in out
    assert run_cli("plot", "branch.zarr")[0] == 0 and run_cli("report", "branch.zarr", "-o", "a.html")[0] == 0
    assert "not finished" in Path("a.html").read_text()
    assert run_cli("sweep", "branch.toml", "-o", "branch.zarr")[0] == 0
    finished = rb.open_study("branch.zarr")
    assert before < finished.sizes["point"]
    assert "not finished" not in run_cli("show", "branch.zarr")[1]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_branch_with_a_way_to_resume(number: int, run_cli: RunCli) -> None:
    """Ctrl-C and SIGTERM end the command with their exit codes, and print how to resume."""
    Path("branch.toml").write_text(STUDY.replace("step = 0.02", "step = 0.0005"))
    command = [sys.executable, "-m", "rattlebox.cli", "sweep", "branch.toml"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for(partial_file("branch.zarr").is_file)
    os.kill(process.pid, number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 128 + number, errors
    assert "Traceback" not in errors
    if number == signal.SIGINT:
        assert "in branch.zarr, and the same command resumes from there" in errors


def test_the_store_of_another_branch_is_refused_with_what_differs(run_cli: RunCli) -> None:
    """A store with other limits is not overwritten; the message lists the difference."""
    assert run_cli("sweep", "branch.toml")[0] == 0
    Path("branch.toml").write_text(STUDY.replace("21.6 Hz", "21.5 Hz"))
    code, _, errors = run_cli("sweep", "branch.toml")
    assert code == 2 and "holds another study" in errors and "limits" in errors and "21.5" in errors


def test_a_branch_starts_near_a_run_or_a_state(run_cli: RunCli) -> None:
    """The search begins at the end of a run of `rattlebox run`, or at a state, whose number of components is checked."""
    assert run_cli("run", "case.toml", "-o", "out", "--no-figures")[0] == 0
    own = read_study("branch.toml").run(progress=False)
    Path("branch.toml").write_text('near = "out/run.nc"\n' + STUDY)
    near_run = read_study("branch.toml").run(progress=False)
    np.testing.assert_allclose(near_run.value, own.value, rtol=1e-7)
    state = own.state.isel(point=int(own.attrs["start"])).values
    assert float(own.phase.isel(point=int(own.attrs["start"]))) == 0
    Path("branch.toml").write_text(f"near = {state.tolist()}\nperiod = 1\n" + STUDY)
    np.testing.assert_allclose(read_study("branch.toml").run(progress=False).value, own.value, rtol=1e-7)
    Path("branch.toml").write_text("near = [0.0, 1.0]\n" + STUDY)
    code, _, errors = run_cli("sweep", "branch.toml")
    assert code == 2 and "the case needs 4" in errors


def test_a_file_of_a_branch_is_shown_drawn_and_reported(run_cli: RunCli) -> None:
    """A netCDF file that Python wrote is a result like the folder of a study: it was refused as a run of another program."""
    branch = rb.continue_orbit(
        rb.find_orbit(rb.Case.from_file("case.toml")), "load.frequency", ("19.4 Hz", "21.6 Hz"), progress=False
    )
    branch.save("branch.nc")
    code, out, errors = run_cli("show", "branch.nc")
    assert (code, errors) == (0, "") and "branch.nc: continue orbit, complete" in out
    for line in str(branch).splitlines():
        assert " ".join(line.split()) in " ".join(out.split())
    assert run_cli("plot", "branch.nc", "-o", "branch.svg") == (0, "written: branch.svg\n", "")
    assert run_cli("report", "branch.nc")[0] == 0
    page = Path("branch.html").read_text()
    for words in ("Ranges of stability", "Special points", "multiplier", "impacts a cycle", "study.toml"):
        assert words in page
    assert str(rb.Branch.load("branch.nc")) == str(branch)
    assert run_cli("sweep", "branch.toml")[0] == 0
    assert [kind for kind, _ in specials(rb.Branch.load("branch.zarr").data)] == [
        kind for kind, _ in specials(branch.data)
    ]


def test_files_that_are_no_branch_are_refused(run_cli: RunCli) -> None:
    """Other netCDF files are no study, and the result of another study is no branch."""
    study = rb.lyapunov(rb.Case.from_file("case.toml"), cycles=(5, 5), pairs=1, progress=False)
    study.to_netcdf("other.nc", engine="h5netcdf")
    with pytest.raises(rb.DataError, match="is not a branch"):
        rb.Branch.load("other.nc")
    assert run_cli("show", "other.nc")[0] == 0
    study.assign_attrs(study="").drop_attrs().to_netcdf("plain.nc", engine="h5netcdf")
    for command in ("show", "plot", "report"):
        code, _, errors = run_cli(command, "plain.nc")
        assert code == 2 and "plain.nc" in errors
    Path("broken.nc").write_bytes(Path("other.nc").read_bytes()[:900])
    assert run_cli("report", "broken.nc")[0] == 2


def test_the_time_of_a_branch_is_predicted(run_cli: RunCli) -> None:
    """The estimate names points and one worker, and leaves no store."""
    code, out, errors = run_cli("sweep", "branch.toml", "--estimate")
    assert (code, errors) == (0, "")
    assert "points: about" in out and "1 worker" in out
    assert not Path("branch.zarr").exists()


def test_the_number_of_points_is_predicted(run_cli: RunCli) -> None:
    """The number of points of the estimate depends on the range, and is right within the factor of 3 that is stated.

    It was 100 for every branch. The longer range ends above a grazing near 19.2 Hz, past which the motion that a search
    finds, and with it the number of points, depends on the last bit.
    """
    text = Path("branch.toml").read_text()
    for number, limits in enumerate(('["19.6 Hz", "26 Hz"]', '["20.5 Hz", "21 Hz"]')):
        lines = [f"limits = {limits}" if line.startswith("limits") else line for line in text.splitlines()]
        Path(f"range{number}.toml").write_text("\n".join(lines))
        out = run_cli("sweep", f"range{number}.toml", "--estimate")[1]
        predicted = int(out.partition(": ")[2].partition(" points")[0])
        out = run_cli("sweep", f"range{number}.toml")[1]
        points = int(out.partition(" points.")[0].rpartition(" ")[2])
        assert 1 / 3 < predicted / points < 3
