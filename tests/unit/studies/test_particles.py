"""Sweeps over cases with particles in space: each variant is the run that simulate gives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import shaken_cavity
from rattlebox.prepare import settle
from rattlebox.results import Run
from rattlebox.studies import particle_work
from rattlebox.studies.axes import read_axes
from rattlebox.studies.runner import Stopped

AMPLITUDE, FREQUENCY = "structure.motion.amplitude", "structure.motion.frequency"


def box(**changes: Any) -> rb.ParticleDamper:
    """Return a box with a dozen balls."""
    usual: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=12),
        "cavity": rb.Box(size=("15 mm", "15 mm", "20 mm")),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.2,
        "packing": rb.Settled(seed=1),
        "softening": 1000,
    }
    return rb.ParticleDamper(**{**usual, **changes})


def shaken(**changes: Any) -> rb.Case:
    """Return the box on a shaker along z."""
    motion = rb.Harmonic(amplitude=(60, "m/s^2"), frequency=50, direction="z")
    usual: dict[str, Any] = {"structure": rb.Shaker(motion=motion), "dampers": [box()], "duration": "0.06 s"}
    return rb.Case(**{**usual, **changes})


def struck(**changes: Any) -> rb.Case:
    """Return the box on a structure that swings."""
    usual: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping="100 N s/m", velocity="0.5 m/s"),
        "damper": box(direction="z"),
        "duration": "0.08 s",
    }
    return rb.Case(**{**usual, **changes})


def turned(run: rb.Run) -> float:
    """Return the energy of all spins at the end."""
    assert isinstance(run, Run)
    return float(run.arrays.rotation_energy[-1].sum())


def test_variants_are_runs() -> None:
    """Measures and functions of a run are those of each variant run alone, for any number of threads, to the last bit."""
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
    result = rb.sweep(struck(), axes, [*names, turned], workers=2, progress=False)
    assert (result.status == 0).all()
    assert result.peak.attrs["units"] == "m"
    for i, restitution in enumerate([0.5, 0.9]):
        alone = rb.simulate(struck(damper=box(direction="z", contact=rb.Tsuji(restitution=restitution))))
        one = result.isel({"damper.contact.restitution": i, "structure.velocity": 1})
        assert float(one.turned) == turned(alone)
        assert float(one.motion_share) == alone.ledger.shares["motion"]
        assert float(one.impact_share) == pytest.approx(sum(alone.ledger.partner_share), rel=1e-12)
        assert float(one.energy_residual) == alone.energy_residual
        assert float(one.peak) == np.abs(alone.arrays.displacement).max()
        assert float(one.peak_velocity) == np.abs(alone.arrays.velocity).max()
        settled = rb.analysis.settling_time(alone.arrays.time, alone.arrays.displacement[:, 0])
        assert float(one.settling_time) == settled < 0.08
    again = rb.sweep(struck(), axes, [*names, turned], workers=1, progress=False)
    assert again.equals(result)


@pytest.mark.parametrize("samples", [128, 200, 333])
def test_windows_hold_whole_cycles(samples: int) -> None:
    """However many samples are asked for, measures look at just the cycles that are."""

    def in_two_cycles(run: Run) -> float:
        result = shaken_cavity(run, frequency=50.0, after=0.02 - 1e-12)
        assert result.attrs["cycles"] == 2
        return float(result.effective_mass[0])

    result = rb.sweep(
        shaken(), {FREQUENCY: ["50 Hz"]}, ["effective_mass", in_two_cycles], cycles=(1, 2), samples=samples
    )
    assert result.effective_mass.item() == pytest.approx(result.in_two_cycles.item(), rel=1e-9)


def test_friction_is_a_number_along_an_axis() -> None:
    """Friction that is given as a number is one in axes and random designs, with the runs that its coefficient gives."""
    spread = rb.linspace(0.1, 0.5, 3)
    result = rb.sweep(shaken(), {"damper.friction": spread}, "impact_loss")
    same = rb.sweep(shaken(), {"damper.friction.coefficient": spread}, "impact_loss")
    np.testing.assert_allclose(result["damper.friction"], [0.1, 0.3, 0.5], rtol=1e-15)
    np.testing.assert_array_equal(result.impact_loss, same.impact_loss)
    bounds = rb.random_design({"damper.friction": (0.1, 0.5), "damper.rolling": (0.01, 0.02)}, 4, seed=1)
    drawn = rb.sweep(shaken(dampers=[box(rolling=0.01)]), bounds, "impact_loss")
    assert len({*drawn["damper.friction"].values.tolist()}) == len({*drawn["damper.rolling"].values.tolist()}) == 4


def test_windows_begin_between_samples() -> None:
    """A time to skip that is no sample's is where the window begins, with what the line between its neighbours says."""
    run = rb.simulate(shaken(duration="0.02 s", output=rb.Output(rate=1000)))
    window = particle_work.cut_before(run, 0.0104).arrays
    assert window.time[0] == 0.0104
    assert window.time[1] == run.arrays.time[11]
    between = 0.6 * run.arrays.cavity_displacement[10] + 0.4 * run.arrays.cavity_displacement[11]
    np.testing.assert_allclose(window.cavity_displacement[0], between, rtol=1e-12)


def test_too_little_for_a_cycle_is_told_before_anything_runs() -> None:
    """Measures of a cycle are refused where what is left after the time to skip holds none."""
    with pytest.raises(rb.CaseError, match="one cycle that loss_factor requires"):
        rb.sweep(shaken(), {AMPLITUDE: ["50 m/s^2"]}, "loss_factor", skip="0.055 s")


@pytest.mark.parametrize("window", [{"cycles": (1, 2), "samples": 10}, {"skip": "20 ms", "samples": 5}])
def test_too_few_samples_for_the_first_harmonic_are_refused(window: Any) -> None:
    """Samples from which no first harmonic is known are refused where it is asked for, and taken where it is not."""
    with pytest.raises(rb.CaseError, match=r"too few for loss_factor, which requires 8\n  try: more"):
        rb.sweep(shaken(), {AMPLITUDE: ["50 m/s^2"]}, ["loss_per_cycle", "loss_factor"], progress=False, **window)
    result = rb.sweep(shaken(), {AMPLITUDE: ["50 m/s^2"]}, "loss_per_cycle", progress=False, **window)
    assert np.isfinite(result.loss_per_cycle).all()


def test_samples_are_those_of_each_variant() -> None:
    """Samples that are too few for the case itself, but not for its variants, are enough."""
    case = shaken(output=rb.Output(rate=300))
    slow = {"structure.motion.frequency": [20.0, 30.0, 50.0]}
    result = rb.sweep(case, slow, ["loss_factor"], progress=False)
    assert result.status.values.tolist() == [0, 0, 9]
    assert "6 samples per cycle are too few for loss_factor" in result.attrs["refused"]


def test_a_cavity_that_stands_still_has_no_cycles() -> None:
    """Of a shaker or a load without amplitude, measures of cycles are NaN, and the others are what they are."""
    measures = ["rms", "loss_factor", "reduced_loss", "effective_mass", "loss_per_cycle"]
    load = {"load": rb.Harmonic(amplitude="10 N", frequency=50)}
    for case, axis, unit in ((shaken(), AMPLITUDE, "m/s^2"), (struck(**load), "load.amplitude", "N")):
        still = rb.sweep(case, {axis: [f"0 {unit}", f"20 {unit}"]}, measures, cycles=(1, 1), progress=False)
        assert (still.status == 0).all()
        assert np.isfinite(still.rms).all()
        for name in measures[1:]:
            assert np.isnan(still[name].values).tolist() == [True, False]


def test_what_has_not_begun_has_no_cycles() -> None:
    """Cycles that are looked at before a harmonic load or motion begins are refused, those of one variant by its status."""
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


def test_windows_leave_out_what_is_before() -> None:
    """Work, losses and shares count from the begin of the window, whose ledger closes by itself."""
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


def test_loss_maps_hold_what_the_analysis_finds() -> None:
    """A loss map of particles has masses, loss factor and loss of the analysis of each run."""
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


def test_two_cavities_weigh_together() -> None:
    """Two like cavities on one shaker have twice the apparent mass of one, and the same loss factor."""
    names = ["effective_mass", "damping_mass", "loss_factor", "reduced_loss"]
    options: dict[str, Any] = {"cycles": (2, 3), "progress": False}
    one = rb.sweep(shaken(), {AMPLITUDE: [60.0]}, names, **options)
    both = rb.sweep(shaken(dampers=[box(), box(name="b")]), {AMPLITUDE: [60.0]}, names, **options)
    for name, factor in (("effective_mass", 2), ("damping_mass", 2), ("loss_factor", 1), ("reduced_loss", 1)):
        assert both[name].item() == pytest.approx(factor * one[name].item(), rel=1e-9)


def test_a_stop_loses_no_finished_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is finished is in the store; the same call runs only what is missing, to the same bits."""
    store, axes = tmp_path / "study.zarr", {"damper.packing.seed": [1, 2, 3, 4]}

    def stopping(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(Stopped, match="2 of 4 variants are in"):
        rb.sweep(struck(), axes, "impact_share", store=store, workers=1, progress=stopping)
    ran = []
    simulate = particle_work.simulate_dem
    monkeypatch.setattr(
        particle_work, "simulate_dem", lambda case, **options: (ran.append(case), simulate(case, **options))[1]
    )
    result = rb.sweep(struck(), axes, "impact_share", store=store, workers=1, progress=False)
    assert len(ran) == 2
    whole = rb.sweep(struck(), axes, "impact_share", progress=False)
    assert result.impact_share.values.tobytes() == whole.impact_share.values.tobytes()
    assert len(set(whole.impact_share.values)) == 4


def test_corners_that_cannot_be_run_have_a_status() -> None:
    """A variant whose given step is too long is refused by itself; the others are run."""
    case = struck(method=rb.Dem(dt="40 us"))
    result = rb.sweep(case, {"damper.softening": [1e5, 1.0]}, "impact_share", progress=False)
    assert result.status.values.tolist() == [0, result.status.attrs["flag_meanings"].split().index("refused")]
    assert np.isfinite(result.impact_share.values).tolist() == [True, False]
    why = result.attrs["refused"].splitlines()
    assert why[0] == "damper.softening = 1" and "40.0 µs is too long" in why[2]


def test_stores_keep_why_a_variant_is_refused(tmp_path: Path) -> None:
    """A study that is read from disk has the reason of a refusal, as the one that was returned, also when it ran before."""
    case, axes = struck(method=rb.Dem(dt="40 us")), {"damper.softening": [1e5, 1.0]}
    store = tmp_path / "study.zarr"
    result = rb.sweep(case, axes, store=store, progress=False)
    assert result.attrs["refused"]
    assert rb.open_study(store).attrs["refused"] == result.attrs["refused"]
    assert rb.sweep(case, axes, store=store, progress=False).attrs["refused"] == result.attrs["refused"]


def test_runs_that_leave_their_bounds_are_marked() -> None:
    """Each run's flags are its own warnings: overlaps that are too deep, contacts of too few steps."""
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


@pytest.mark.parametrize("complaint", REFUSED)
def test_what_does_not_fit_is_refused(complaint: str) -> None:
    """What particles in space do not have is refused before anything runs, with its reason."""
    with pytest.raises(rb.CaseError, match=complaint):
        rb.sweep(struck(), {"structure.mass": [1.0, 2.0]}, **REFUSED[complaint])


def test_other_studies_say_that_they_are_for_impact_dampers() -> None:
    """Maps that follow a motion refuse particles in space, and say which studies do not."""
    with pytest.raises(rb.CaseError, match=r"not particle dampers\n  try: a sweep, a loss map"):
        rb.bifurcation(shaken(), AMPLITUDE, [10.0, 20.0], progress=False)


def test_stops_are_heard(monkeypatch: pytest.MonkeyPatch) -> None:
    """A task that is told to stop ends within a run, and within the settling before it."""
    case = shaken(duration="1000 s", dampers=[box(packing=rb.Settled(seed=9))])
    task = particle_work.ParticleWork(case, read_axes(case, {AMPLITUDE: [60.0]}), ["work"])
    assert task.run(0, 1, cancelled=lambda: True) is None
    calls: list[bool] = []
    monkeypatch.setattr(particle_work, "settle_all", lambda case, proceed: True)
    assert task.run(0, 1, cancelled=lambda: (calls.append(True), len(calls) > 3)[1]) is None


def test_beds_are_settled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What does not touch the fall starts from the same bed; another seed, size or friction has a bed of its own."""
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
