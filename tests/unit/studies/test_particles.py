"""Sweeps over cases with particle dampers: each variant equals a single run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import particle_dampers

import rattlebox as rb
from rattlebox.analysis import shaken_cavity
from rattlebox.prepare import settle
from rattlebox.results import Run
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.work import particles
from rattlebox.studies.work.variants import Variants
from rattlebox.studies.work.window import cut_before

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"


def box(**changes: Any) -> rb.ParticleDamper:
    """Return a box with a dozen balls."""
    usual: dict[str, Any] = {
        "particles": particle_dampers.balls(12, diameter="5 mm"),
        "cavity": rb.Box(size=("15 mm", "15 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.2,
        "packing": rb.Settled(seed=1),
        "softening": 1000,
    }
    return particle_dampers.damper(**(usual | changes))


def shaken(**changes: Any) -> rb.Case:
    """Return the box on a shaker along z."""
    motion = rb.Harmonic(amplitude=(60, "m/s^2"), frequency=50, direction="z")
    usual: dict[str, Any] = {"structure": rb.Shaker(motion=motion), "dampers": [box()], "duration": "0.06 s"}
    return rb.Case(**{**usual, **changes})


def struck(**changes: Any) -> rb.Case:
    """Return the box on a structure with an initial velocity."""
    usual: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping="100 N s/m", velocity="0.5 m/s"),
        "damper": box(direction="z"),
        "duration": "0.08 s",
    }
    return rb.Case(**{**usual, **changes})


def spin_energy(run: rb.Run) -> float:
    """Return the rotational energy of all particles at the end."""
    assert isinstance(run, Run)
    return float(run.arrays.rotation_energy[-1].sum())


def test_variants_are_runs() -> None:
    """Measures of each variant equal those of a single run, and the bits do not depend on the number of threads."""
    axes = {"damper.contact.restitution": [0.5, 0.9], "structure.velocity": ["0.2 m/s", "0.5 m/s"]}
    names = [
        "viscous_share",
        "impact_share",
        "motion_share",
        "work",
        "energy_residual",
        "peak",
        "peak_velocity",
        "settling_time",
    ]
    result = rb.sweep(struck(), axes, [*names, spin_energy], workers=2, progress=False)
    assert (result.status == 0).all()
    assert result.peak.attrs["units"] == "m"
    for i, restitution in enumerate([0.5, 0.9]):
        alone = rb.simulate(struck(damper=box(direction="z", contact=rb.Tsuji(restitution=restitution))))
        one = result.isel({"damper.contact.restitution": i, "structure.velocity": 1})
        assert float(one.spin_energy) == spin_energy(alone)
        assert float(one.motion_share) == alone.ledger.shares["motion"]
        assert float(one.impact_share) == pytest.approx(sum(alone.ledger.partner_share), rel=1e-12)
        assert float(one.energy_residual) == alone.energy_residual
        assert float(one.peak) == np.abs(alone.arrays.displacement).max()
        assert float(one.peak_velocity) == np.abs(alone.arrays.velocity).max()
        settled = rb.analysis.settling_time(alone.arrays.time, alone.arrays.displacement[:, 0])
        assert float(one.settling_time) == settled < 0.08
    again = rb.sweep(struck(), axes, [*names, spin_energy], workers=1, progress=False)
    assert again.equals(result)


@pytest.mark.parametrize("samples", [128, 200, 333])
def test_windows_hold_whole_cycles(samples: int) -> None:
    """Measures are evaluated over exactly the given cycles for any number of samples."""

    def in_two_cycles(run: Run) -> float:
        result = shaken_cavity(run, frequency=50.0, after=0.02 - 1e-12)
        assert result.attrs["cycles"] == 2
        return float(result.effective_mass[0])

    result = rb.sweep(
        shaken(), {FREQUENCY: ["50 Hz"]}, ["effective_mass", in_two_cycles], cycles=(1, 2), samples=samples
    )
    assert result.effective_mass.item() == pytest.approx(result.in_two_cycles.item(), rel=1e-9)


def test_friction_is_a_number_along_an_axis() -> None:
    """Friction varies as a number in axes and random designs, with the same result as its coefficient."""
    spread = rb.linspace(0.1, 0.5, 3)
    result = rb.sweep(shaken(), {"damper.friction": spread}, "impact_loss")
    same = rb.sweep(shaken(), {"damper.friction.coefficient": spread}, "impact_loss")
    np.testing.assert_allclose(result["damper.friction"], [0.1, 0.3, 0.5], rtol=1e-15)
    np.testing.assert_array_equal(result.impact_loss, same.impact_loss)
    bounds = rb.random_design({"damper.friction": (0.1, 0.5), "damper.rolling": (0.01, 0.02)}, 4, seed=1)
    drawn = rb.sweep(shaken(dampers=[box(rolling=0.01)]), bounds, "impact_loss")
    assert len({*drawn["damper.friction"].values.tolist()}) == len({*drawn["damper.rolling"].values.tolist()}) == 4


def test_windows_begin_between_samples() -> None:
    """A window that begins between two samples begins with the interpolated values."""
    run = rb.simulate(shaken(duration="0.02 s", output=rb.Output(rate=1000)))
    window = cut_before(run, 0.0104).arrays
    assert window.time[0] == 0.0104
    assert window.time[1] == run.arrays.time[11]
    between = 0.6 * run.arrays.cavity_displacement[10] + 0.4 * run.arrays.cavity_displacement[11]
    np.testing.assert_allclose(window.cavity_displacement[0], between, rtol=1e-12)


def test_windows_shorter_than_a_cycle_are_refused() -> None:
    """Measures per cycle are refused if the window after the skipped time is shorter than a cycle."""
    with pytest.raises(rb.CaseError, match="one cycle that loss_factor requires"):
        rb.sweep(shaken(), {AMPLITUDE: ["50 m/s^2"]}, "loss_factor", skip="0.055 s")


@pytest.mark.parametrize("window", [{"cycles": (1, 2), "samples": 10}, {"skip": "20 ms", "samples": 5}])
def test_too_few_samples_for_the_first_harmonic_are_refused(window: Any) -> None:
    """Too few samples for the first harmonic are refused only for measures that need it."""
    with pytest.raises(rb.CaseError, match=r"too few for loss_factor, which requires 8\n  try: more"):
        rb.sweep(shaken(), {AMPLITUDE: ["50 m/s^2"]}, ["loss_per_cycle", "loss_factor"], progress=False, **window)
    result = rb.sweep(shaken(), {AMPLITUDE: ["50 m/s^2"]}, "loss_per_cycle", progress=False, **window)
    assert np.isfinite(result.loss_per_cycle).all()


def test_the_number_of_samples_is_checked_for_each_variant() -> None:
    """Samples per cycle are checked for each variant, not for the base case."""
    case = shaken(output=rb.Output(rate=300))
    slow = {"structure.motion.frequency": [20.0, 30.0, 50.0]}
    result = rb.sweep(case, slow, ["loss_factor"], progress=False)
    assert result.status.values.tolist() == [0, 0, 9]
    assert "6 samples per cycle are too few for loss_factor" in result.attrs["refused"]


def test_measures_per_cycle_without_excitation_are_nan() -> None:
    """With an amplitude of zero, measures per cycle are NaN and the other measures are finite."""
    measures = ["rms", "loss_factor", "reduced_loss", "effective_mass", "loss_per_cycle"]
    load = {"load": rb.Harmonic(amplitude="10 N", frequency=50)}
    for case, axis, unit in ((shaken(), AMPLITUDE, "m/s^2"), (struck(**load), "load.amplitude", "N")):
        still = rb.sweep(case, {axis: [f"0 {unit}", f"20 {unit}"]}, measures, cycles=(1, 1), progress=False)
        assert (still.status == 0).all()
        assert np.isfinite(still.rms).all()
        for name in measures[1:]:
            assert np.isnan(still[name].values).tolist() == [True, False]


def test_cycles_before_the_start_of_the_load_are_refused() -> None:
    """Cycles before the start of the harmonic load are refused; a variant with them has a status."""
    late = shaken(structure=rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency=50, direction="z", start="1 s")))
    for study in (
        lambda: rb.sweep(late, {"damper.packing.seed": [1, 2]}, ["rms"], cycles=(1, 1)),
        lambda: rb.loss_map(late, ["1 mm"], [50], cycles=(1, 1)),
    ):
        with pytest.raises(rb.CaseError, match=r"start at 0.02 s, before the harmonic at 1 s\n  try: start = 0"):
            study()
    starts = {"structure.motion.start": ["20 ms", "21 ms"]}
    some = rb.sweep(shaken(), starts, ["loss_factor"], cycles=(1, 1), progress=False)
    assert some.status.values.tolist() == [0, 9] and np.isfinite(some.loss_factor.values[0])


def test_measures_refer_to_the_window() -> None:
    """Work, losses and shares are evaluated from the start of the window, with a small energy residual."""
    result = rb.sweep(
        struck(),
        {"structure.damping": [0.0, 100.0]},
        ["viscous_loss", "impact_loss", "motion_share", "energy_residual", "peak"],
        skip="30 ms",
        samples=101,
        progress=False,
    ).isel({"structure.damping": 1})
    case = struck(output=rb.Output(rate=100 / 0.05))
    arrays, ledger = (run := rb.simulate(case)).arrays, run.ledger
    first = np.searchsorted(arrays.time, 0.03 - 1e-12)
    assert float(result.viscous_loss) == pytest.approx(arrays.viscous_loss[-1] - arrays.viscous_loss[first], rel=1e-12)
    lost = ledger.contact_loss[-1] - ledger.contact_loss[first]
    assert float(result.impact_loss) == pytest.approx(lost, rel=1e-12)
    fallen = ledger.gravity[first] - ledger.gravity[-1]
    share = ledger.motion[-1] / (ledger.motion[first] + ledger.work[-1] - ledger.work[first] + fallen)
    assert float(result.motion_share) == pytest.approx(share, rel=1e-12)
    assert float(result.energy_residual) < 1e-3
    assert float(result.peak) == np.abs(arrays.displacement[first:]).max()


def test_loss_maps_agree_with_the_analysis() -> None:
    """Masses, loss factor and loss in a loss map are those of the analysis of each run."""
    result = rb.loss_map(
        shaken(), [(20, "m/s^2"), (90, "m/s^2")], [40.0, 60.0], cycles=(2, 4), samples=401, progress=False
    )
    assert result.loss_factor.dims == (AMPLITUDE, FREQUENCY)
    assert (result.status == 0).all()
    assert "impacts_per_cycle" not in result
    mass = 12 * 7850 * np.pi / 6 * 0.005**3
    assert float(result.particle_mass) == pytest.approx(mass)
    motion = rb.Harmonic(amplitude=(90, "m/s^2"), frequency=60, direction="z")
    case = shaken(structure=rb.Shaker(motion=motion), duration=6 / 60, output=rb.Output(rate=100 * 60))
    alone = rb.analysis.shaken_cavity(rb.simulate(case), frequency=60, after=2 / 60)
    one = result.isel({AMPLITUDE: 1, FREQUENCY: 1})
    by_force, by_energy = alone.sel(way="complex power"), alone.sel(way="energy")
    assert float(one.effective_mass) == pytest.approx(float(by_force.effective_mass), rel=1e-9)
    assert float(one.loss_factor) == pytest.approx(abs(float(by_force.loss_factor)), rel=1e-9)
    assert float(one.loss_per_cycle) == pytest.approx(float(by_energy.loss_per_cycle), rel=1e-6)
    assert float(one.reduced_loss) == pytest.approx(float(by_energy.reduced_loss), rel=1e-6)


def test_effective_masses_of_two_cavities_add_up() -> None:
    """Two equal cavities on one shaker have twice the effective mass of one, and the same loss factor."""
    names = ["effective_mass", "damping_mass", "loss_factor", "reduced_loss"]
    options: dict[str, Any] = {"cycles": (2, 3), "progress": False}
    one = rb.sweep(shaken(), {AMPLITUDE: [60.0]}, names, **options)
    both = rb.sweep(shaken(dampers=[box(), box(name="b")]), {AMPLITUDE: [60.0]}, names, **options)
    for name, factor in (("effective_mass", 2), ("damping_mass", 2), ("loss_factor", 1), ("reduced_loss", 1)):
        assert both[name].item() == pytest.approx(factor * one[name].item(), rel=1e-9)


def test_a_stop_loses_no_finished_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Finished variants are in the store; the same call computes only the missing ones, with the same bits."""
    store, axes = tmp_path / "study.zarr", {"damper.packing.seed": [1, 2, 3, 4]}

    def stopping(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(Stopped, match="2 of 4 variants are in"):
        rb.sweep(struck(), axes, "impact_share", store=store, workers=1, progress=stopping)
    cases = []
    simulate = particles.simulate_dem
    monkeypatch.setattr(
        particles, "simulate_dem", lambda case, **options: (cases.append(case), simulate(case, **options))[1]
    )
    result = rb.sweep(struck(), axes, "impact_share", store=store, workers=1, progress=False)
    assert len(cases) == 2
    whole = rb.sweep(struck(), axes, "impact_share", progress=False)
    assert result.impact_share.values.tobytes() == whole.impact_share.values.tobytes()
    assert len(set(whole.impact_share.values)) == 4


def test_variants_that_cannot_run_have_a_status() -> None:
    """A variant with too long a step has the status refused; the others are computed."""
    case = struck(method=rb.Dem(dt="40 us"))
    result = rb.sweep(case, {"damper.softening": [1e5, 1.0]}, "impact_share", progress=False)
    assert result.status.values.tolist() == [0, result.status.attrs["flag_meanings"].split().index("refused")]
    assert np.isfinite(result.impact_share.values).tolist() == [True, False]
    why = result.attrs["refused"].splitlines()
    assert why[0] == "damper.softening = 1" and "40.0 µs is too long" in why[2]


def words(run: rb.Run) -> Any:
    """Return no number."""
    return "many"


def missing_part(run: rb.Run) -> float:
    """Raise an error of the package."""
    raise rb.CaseError("there is no such part", "another part")


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (words, "measure words: the function returned str for variant \\d, not one number\n  try: float"),
        (missing_part, "measure missing_part, variant \\d: there is no such part\n  try: another part"),
    ],
)
@pytest.mark.parametrize("options", [{}, {"backend": "processes", "workers": 2}], ids=["threads", "processes"])
def test_an_error_of_a_function_ends_the_study(function: Any, message: str, options: Any) -> None:
    """A function that returns no number, or raises an error of the package, is named and ends sweeps and designs.

    Variants were refused without a reason instead; only sweeps and designs of 1-D runs were tested with such functions.
    """
    with pytest.raises(rb.CaseError, match=message):
        rb.sweep(struck(), {"damper.particles.count": [8, 12]}, function, progress=False, **options)
    if not options:
        with pytest.raises(rb.CaseError, match=message):
            rb.design(struck(), {"damper.particles.count": [8, 12]}, function, packings=1, progress=False)


def test_stores_have_the_reason_of_a_refusal(tmp_path: Path) -> None:
    """A study opened from disk and a repeated call have the reason of a refusal."""
    case, axes = struck(method=rb.Dem(dt="40 us")), {"damper.softening": [1e5, 1.0]}
    store = tmp_path / "study.zarr"
    result = rb.sweep(case, axes, store=store, progress=False)
    assert result.attrs["refused"]
    assert rb.open_study(store).attrs["refused"] == result.attrs["refused"]
    assert rb.sweep(case, axes, store=store, progress=False).attrs["refused"] == result.attrs["refused"]


def test_validity_warnings_are_flags() -> None:
    """The flags of each variant are the warnings of its run: deep overlaps and too few steps per contact."""
    cases = {"damper.softening": [1.0, 1e5], "method.dt": ["0.1 us", "2 us"]}
    result = rb.sweep(struck(method=rb.Dem(dt="0.1 us"), duration="5 ms"), cases, "impact_share", progress=False)
    about = result.warnings.attrs
    flags = dict(zip(about["flag_meanings"].split(), about["flag_masks"], strict=True))
    assert result.status.values.tolist() == [[0, 0], [0, 0]] and "refused" not in result.attrs
    for at in np.ndindex(2, 2):
        values = {
            "damper.softening": result["damper.softening"].values[at[0]],
            "method.dt": result["method.dt"].values[at[1]],
        }
        notes = " ".join(rb.simulate(struck(duration="5 ms").replaced(values)).notes)
        bits = int(result.warnings.values[at])
        assert bool(bits & flags["few_steps"]) == ("steps in the shortest contact" in notes)
        assert bool(bits & flags["deep_overlap"]) == ("overlaps reach" in notes)
    assert np.unique(result.warnings.values & flags["few_steps"]).size == 2
    assert np.unique(result.warnings.values & flags["deep_overlap"]).size == 2


REFUSED = {
    "impacts refers to single impacts": {"measure": "impacts"},
    "loss_factor is defined per cycle": {"measure": "loss_factor"},
    "motion and last are for impact dampers only": {"motion": True},
    "cycles require a harmonic load or motion": {"cycles": (1, 1)},
    "is not before the end of the run": {"skip": "1 s"},
    "there is no point 'tip'": {"point": "tip"},
}


@pytest.mark.parametrize("message", REFUSED)
def test_bad_arguments_are_refused(message: str) -> None:
    """Arguments that particle dampers do not support are refused before the first run."""
    with pytest.raises(rb.CaseError, match=message):
        rb.sweep(struck(), {"structure.mass": [1.0, 2.0]}, **REFUSED[message])


def test_continuation_is_for_impact_dampers() -> None:
    """Studies with continuation refuse particle dampers and propose other studies."""
    with pytest.raises(rb.CaseError, match=r"not particle dampers\n  try: a sweep, a loss map"):
        rb.bifurcation(shaken(), AMPLITUDE, [10.0, 20.0], progress=False)


def test_cancellation(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cancelled task ends within a run and within the settling before it."""
    case = shaken(duration="1000 s", dampers=[box(packing=rb.Settled(seed=9))])
    task = particles.ParticleEngine(Variants(case, read_axes(case, {AMPLITUDE: [60.0]}), ["work"]))
    assert task.run(range(1), cancelled=lambda: True) is None
    calls: list[bool] = []
    monkeypatch.setattr(particles, "settle_all", lambda case, proceed: True)
    assert task.run(range(1), cancelled=lambda: (calls.append(True), len(calls) > 3)[1]) is None


def test_beds_are_settled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Dampers that differ only in properties without effect on settling share a bed; others have their own."""
    settle._beds.clear()
    falls = []
    fall = settle._SettlingBed.fall
    monkeypatch.setattr(settle._SettlingBed, "fall", lambda self, *args: (falls.append(1), fall(self, *args))[1])
    first = settle.settle(box())
    for same in (box(contact=rb.Thornton()), box(direction="z", velocity=(0, 0, 1), softening=3)):
        assert np.array_equal(settle.settle(same), first)
    assert len(falls) == 1
    first[:] = 0
    assert settle.settle(box()).any()
    for other in (box(friction=0.3), box(packing=rb.Settled(seed=2)), box(gravity=(0, 0, -5))):
        settle.settle(other)
    assert len(falls) == 4
