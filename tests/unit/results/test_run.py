"""The class Run: energy ledger, datasets, status, lazy imports."""

from __future__ import annotations

import copy
import subprocess
import sys

import numpy as np
import pytest

from rattlebox.results import Run, RunArrays

TIME = np.array([0.0, 1.0, 2.0])


def _column(*values: float) -> np.ndarray:
    return np.array(values)[:, None]


def _open_ledger(**changes: object) -> Run:
    """Return a run with 1 J at the start and 4 J of work, with 0.5 J missing in the middle."""
    arrays = RunArrays(
        time=TIME,
        dampers=("d",),
        balls=("d/1",),
        mode_frequency=np.array([1.0]),
        mode_energy=_column(1.0, 2.0, 0.5),
        ball_energy=_column(0.0, 0.5, 0.25),
        load_work=np.array([0.0, 5.0, 4.0]),
        base_work=np.array([0.0, -1.0, -2.0]),
        viscous_loss=np.array([0.0, 1.0, 1.25]),
        normal_loss=_column(0.0, 1.0, 0.5),
        plastic_loss=_column(0.0, 0.0, 0.5),
    )
    return Run(arrays.replaced(**changes))


def test_energy_residual_of_an_open_ledger() -> None:
    """The residual of a ledger is the missing energy over the energy supplied."""
    run = _open_ledger()
    np.testing.assert_array_equal(run.ledger.residual, [0.0, -0.5, 0.0])
    assert run.energy_residual == 0.5 / (5.0 + 2.0 + 1.0)


def test_shares_of_a_ledger() -> None:
    """Shares refer to the energy supplied by the end, here 3 J, and add up to one."""
    shares = _open_ledger().ledger.shares
    assert shares == {"viscous": 1.25 / 3, "normal": 0.5 / 3, "plastic": 0.5 / 3, "motion": 0.75 / 3}


def test_repr_of_a_ledger() -> None:
    """The repr of a ledger has the supplied energy, the shares and the residual."""
    shares = "viscous 41.67 %, normal 16.67 %, plastic 16.67 %, motion 25.00 %"
    assert repr(_open_ledger().ledger) == f"<Ledger 3.000 J supplied: {shares}; energy residual 6.2e-02>"


def test_zero_of_gravity_does_not_matter() -> None:
    """The energy residual and shares of a falling ball do not depend on the zero of its height."""
    falling = {
        "load_work": np.zeros(3), "base_work": np.zeros(3), "viscous_loss": np.zeros(3),
        "mode_energy": _column(0, 0, 0), "ball_energy": _column(0, 2, 0.5),
        "normal_loss": _column(0, 0, 1.5), "plastic_loss": _column(0, 0, 0),
    }  # fmt: skip
    for zero in (0.0, -3.0, 10.0):
        run = _open_ledger(**falling, gravity_energy=_column(2.0 + zero, 0.25 + zero, zero))
        assert run.energy_residual == 0.25 / 2.0
        assert run.ledger.shares["normal"] == 0.75
        assert run.ledger.shares["motion"] == 0.25


def test_nothing_supplied() -> None:
    """Without any energy the residual is zero and the shares are NaN; a loss without supply has an infinite residual."""
    still = Run(RunArrays(time=TIME))
    assert still.energy_residual == 0.0
    assert all(np.isnan(share) for share in still.ledger.shares.values())
    assert Run(RunArrays(time=TIME, viscous_loss=np.array([0.0, 0.0, 1.0]))).energy_residual == np.inf


def test_undefined_energy_is_not_hidden() -> None:
    """One NaN in an energy makes the energy residual NaN."""
    assert np.isnan(_open_ledger(mode_energy=_column(1.0, np.nan, 0.5)).energy_residual)


def test_example_runs_close(any_run: Run) -> None:
    """The energy residual of the example runs is round-off."""
    assert any_run.energy_residual < 1e-13


def test_status(make_run) -> None:
    """A run that ended early is not ok and has the reason as its message."""
    stopped = make_run(duration=0.01, times=11, status="interrupted", message="Stopped by hand.")
    assert not stopped.ok
    assert stopped.message == "Stopped by hand."
    assert "interrupted" in repr(stopped)


def test_every_variable_is_described(any_run: Run) -> None:
    """Every variable of every dataset has a unit and a long name; each dataset has the provenance."""
    for group in any_run.groups:
        data = getattr(any_run, group)
        for name, variable in data.variables.items():
            assert variable.attrs["long_name"], name
            assert "units" in variable.attrs or variable.dtype.kind == "U", name
        assert data.attrs["case"] == any_run.case_toml
        assert data.attrs["method"] == "hand-made"
        assert data.attrs["seed"] == 7


def test_datasets_are_selected_by_name(two_dampers: Run) -> None:
    """Balls, dampers, points and modes are selected by their labels."""
    arrays = two_dampers.arrays
    ball = two_dampers.motion.relative_position.sel(ball="damper2/3")
    np.testing.assert_array_equal(ball, arrays.relative_position[:, 3])
    assert two_dampers.motion.ball_damper.sel(ball="damper2/1") == 1
    np.testing.assert_array_equal(two_dampers.energy.mode_energy.sel(mode=1), arrays.mode_energy[:, 0])
    second = two_dampers.impacts.where(two_dampers.impacts.damper == 1, drop=True)
    assert second.sizes["impact"] == np.count_nonzero(arrays.impacts.damper == 1)


def test_energy_dataset_balances(run: Run) -> None:
    """Total, work, losses and residual of the dataset satisfy the balance; shares are labelled by channel."""
    energy = run.energy
    left = energy.total - energy.total[0] - energy.work + energy.losses
    assert float(abs(left - energy.residual).max()) < 1e-15
    assert abs(float(energy.share.sum()) - 1) < 1e-12
    assert float(energy.share.sel(channel="normal")) == run.ledger.shares["normal"]


def test_datasets_are_cached(run: Run) -> None:
    """A dataset is built once."""
    assert run.motion is run.motion


def test_import_is_light() -> None:
    """Importing the results and printing a summary loads none of the heavy libraries."""
    code = (
        "import sys, numpy, rattlebox.results as r\n"
        "print(r.Run(r.RunArrays(time=numpy.zeros(1))).summary())\n"
        "heavy = {'xarray', 'matplotlib', 'h5netcdf', 'h5py', 'scipy', 'rich'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_unknown_figures_are_refused_with_the_available_ones(run: Run) -> None:
    """A figure that the run does not have is refused with the names of the available ones."""
    beads = Run(RunArrays(time=TIME, engine="dem"))
    for plots, name, expected in (
        (
            beads.plot,
            "impacts",
            "case, energy, motion, particles, phase_portrait, psd, responses, shock_spectrum, third_octaves",
        ),
        (
            run.plot,
            "particles",
            "case, energy, impacts, motion, phase_portrait, psd, responses, shock_spectrum, third_octaves",
        ),
    ):
        with pytest.raises(AttributeError, match=f"^this run has no figure '{name}'; it has {expected}$"):
            getattr(plots, name)()
        assert not hasattr(plots, name)
    assert copy.copy(run.plot).energy().axes


def test_unknown_ball_is_refused_with_the_available_ones(run: Run) -> None:
    """The error of a portrait of a missing ball lists the balls and points."""
    with pytest.raises(ValueError, match=r"'ball 7'; there are damper1/1, mass"):
        run.plot.phase_portrait("ball 7")
