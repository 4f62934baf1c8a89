"""Contact parameters from ring-downs and losses on a shaker: recovery, intervals, statements, budget, store, errors."""

from __future__ import annotations

import json
import warnings
from io import BytesIO
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

import rattlebox as rb
from rattlebox.studies.calibration.fit import Fit, Space
from rattlebox.studies.calibration.work import CalibrationEngine, simulation_of
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.run.runner import Stopped

E, DAMPING = "damper.contact.restitution", "structure.damping_ratio"
RANGES = {E: (0.4, 0.9)}
LEVELS, DECAYS = ["0.5 mm", "0.8 mm", "1.5 mm"], ["0.4 mm", "0.7 mm", "1.1 mm"]


def case(contact: Any = 0.5, **options: Any) -> rb.Case:
    """Return a case of one ball in free vibration; the contact as a law or as a restitution."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="50 Hz", damping_ratio=0.005),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            contact=rb.Tsuji(restitution=contact) if isinstance(contact, float) else contact,
        ),
        "duration": "1 s",
        "seed": 3,
    }
    return rb.Case(**{**parts, **options})


def shaken(restitution: float, **options: Any) -> rb.ShakerLoss:
    """Return losses of a ball on a shaker, as a loss map has them."""
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="40 Hz"))
    losses = rb.loss_map(case(restitution, structure=shaker), LEVELS, ["40 Hz"], cycles=(20, 40), progress=False)
    name = options.pop("measure", "reduced_loss")
    return rb.ShakerLoss(LEVELS, "40 Hz", **{name: losses[name].values.ravel(), "error": "3 %", **options})


def rung_down(restitution: float, levels: Any = DECAYS, **options: Any) -> rb.RingDown:
    """Return damping ratios of a decay from a random start that no fit has."""
    ratios = rb.damping_curve(case(restitution, seed=100), levels, packings=2, progress=False).damping_ratios.values[1]
    return rb.RingDown(levels, ratios, **{"error": "3 %", **options})


def calibrated(data: Any, ranges: Any = RANGES, contact: Any = 0.5, **options: Any) -> Any:
    """Return a calibration with few runs."""
    return rb.calibrate(data, case(contact), ranges, **{"runs": 26, "progress": False, **options})


# ---- recovery


def test_a_ring_down_gives_the_restitution_of_its_damper() -> None:
    """The interval holds the planted restitution, is narrow, and further starts have the measured damping ratios."""
    data = rung_down(0.7)
    result = calibrated(data)
    assert result.lower.item() < 0.7 < result.upper.item()
    assert result.upper.item() - result.lower.item() < 0.06
    assert result.attrs["undetermined"] == []
    assert result.attrs["p_value"] > 0.01
    np.testing.assert_allclose(result.check, data.damping_ratio, rtol=0.05)


@pytest.mark.parametrize("frequency", [51.7, 10.0658, 217.3])
def test_a_ring_down_of_any_frequency(frequency: float) -> None:
    """The planted restitution is found also if a run has no whole number of samples; 50 Hz had hidden a refusal."""
    structure = rb.SDOF(mass="1 kg", frequency=frequency, damping_ratio=0.005)
    own = case(0.7, structure=structure, duration=50 / frequency, seed=100)
    ratios = rb.damping_curve(own, DECAYS, packings=2, progress=False).damping_ratios.values[1]
    fitted = own.model_copy(update={"seed": 3})
    found = rb.calibrate(rb.RingDown(DECAYS, ratios, error="3 %"), fitted, RANGES, runs=26, progress=False)
    assert found.lower.item() < 0.7 < found.upper.item()


@pytest.mark.parametrize("measure", ["reduced_loss", "loss_per_cycle", "loss_factor"])
def test_losses_on_a_shaker_give_the_restitution(measure: str) -> None:
    """The interval of each kind of loss holds the planted restitution, and is narrow."""
    result = calibrated(shaken(0.7, measure=measure))
    assert result.lower.item() < 0.7 < result.upper.item()
    assert result.upper.item() - result.lower.item() < 0.06
    assert result.measure.values.tolist() == [measure] * 3


def test_ring_down_and_shaker_are_calibrated_together() -> None:
    """Both measurements give a narrower interval than either alone, and values without a unit are noted."""
    ring = rung_down(0.6)
    ring = rb.RingDown(ring.amplitude, ring.damping_ratio, error="3 %")
    both = calibrated([ring, shaken(0.6)])
    assert both.lower.item() < 0.6 < both.upper.item()
    alone = calibrated(ring)
    assert both.upper - both.lower < alone.upper - alone.lower
    assert both.data_set.values.tolist() == [0, 0, 0, 1, 1, 1]
    assert "amplitude has no unit, m is assumed" in " ".join(both.warnings)


def test_a_recorded_decay_has_the_damping_ratios_of_its_run() -> None:
    """`from_signal` gives the damping ratios that the run has by its formula, and refuses amplitudes outside of it."""
    structure = rb.SDOF(mass="1 kg", frequency="50 Hz", damping_ratio=0.02, velocity="0.5 m/s")
    run = rb.simulate(rb.Case(structure=structure, duration="1 s", output=rb.Output(rate="5 kHz")))
    time, motion = run.arrays.time, run.arrays.displacement[:, 0]
    data = rb.RingDown.from_signal(time, motion, ["0.2 mm", "0.5 mm"], error="1 %")
    assert data.damping_ratio == pytest.approx([0.02, 0.02], rel=2e-3)
    assert data.unit == "m"
    with pytest.raises(rb.CaseError, match=r"amplitudes\[2\]\n.*does not pass"):
        rb.RingDown.from_signal(time, motion, ["0.2 mm", "0.5 mm", "1.6 mm"], error="1 %")


def test_accelerations_are_those_at_the_frequency_of_the_mode() -> None:
    """Amplitudes as accelerations give the same samples as the displacements that belong to them."""
    ratio = (2 * np.pi * 50) ** 2
    ratios = [0.0214, 0.0140, 0.0108]
    by_acceleration = rb.RingDown([f"{each * 1e-3 * ratio} m/s^2" for each in (0.4, 0.7, 1.1)], ratios, error="3 %")
    by_displacement = rb.RingDown(DECAYS, ratios, error="3 %")
    one, other = (calibrated(data) for data in (by_acceleration, by_displacement))
    np.testing.assert_allclose(one.simulated, other.simulated, rtol=1e-6)


def test_a_box_of_particles_is_calibrated_by_both_measurements(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each sample has a packing of its own; ring-down and shaker of one box together bound its restitution."""
    monkeypatch.setattr("rattlebox.studies.run.estimate.TIMED", 0.02)
    monkeypatch.setattr("rattlebox.studies.calibration.calibrate._ROUNDS", 1)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=6),
        cavity=rb.Box(size=("10 mm",) * 3),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        softening=1e5,
        direction="z",
        packing=rb.Lattice(seed=900),
    )
    box = case(structure=rb.SDOF(mass="25 g", frequency="80 Hz", damping_ratio=0.005), damper=damper, duration="0.3 s")
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="10 g_0", frequency="80 Hz", direction="z"))
    levels = ["10 g_0", "30 g_0"]
    measured = rb.loss_map(
        box.model_copy(update={"structure": shaker}), levels, ["80 Hz"], cycles=(3, 6), progress=False
    ).reduced_loss.values.ravel()
    losses = rb.ShakerLoss(levels, "80 Hz", reduced_loss=measured, error="5 %", cycles=(3, 6))
    ratios = rb.damping_curve(box, ["0.3 mm", "0.6 mm"], packings=1, progress=False).damping_ratio.values
    decay = rb.RingDown(["0.3 mm", "0.6 mm"], ratios, error="5 %")
    fitted = box.model_copy(update={"dampers": (damper.model_copy(update={"packing": rb.Lattice(seed=1)}),)})
    result = rb.calibrate([losses, decay], fitted, RANGES, runs=24, checks=2, budget="1 h", progress=True)
    assert "at most 26 samples" in capsys.readouterr().err
    assert np.isfinite(result.simulated).mean() > 0.9
    assert (result.check_deviation > 0).all()
    assert result.lower.item() < 0.7 < result.upper.item()


@pytest.mark.slow
def test_friction_of_a_filled_box_follows_from_its_ring_down_and_a_drop_test() -> None:
    """48 balls in the box of the example, with another packing: the intervals hold both values, and bound the friction."""

    def box(restitution: float, friction: float, seed: int) -> rb.Case:
        damper = rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=48),
            cavity=rb.Box(size=("30 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=restitution),
            friction=friction,
            softening=1000,
            packing=rb.Settled(seed=seed),
        )
        return case(
            structure=rb.SDOF(mass="1 kg", frequency="30 Hz", damping_ratio=0.002), damper=damper, duration="1.6 s"
        )

    levels = [1e-3 * level for level in (1.66, 2.21, 3.04, 4.14)]
    ratios = rb.damping_curve(box(0.9, 0.25, 5000), levels, packings=1, progress=False).damping_ratio.values
    noisy = ratios * (1 + 0.02 * np.random.default_rng(1).standard_normal(4))
    decay = rb.RingDown((levels, "m"), noisy, error="2 %")
    ranges = {E: (0.8, 0.97), "damper.friction": (0.0, 0.6)}
    options: dict[str, Any] = {"known": {E: (0.901, 0.004)}, "runs": 30, "checks": 4, "budget": "1 h", "workers": 1}
    result = rb.calibrate(decay, box(0.8, 0.3, 0), ranges, **options)
    assert (result.lower.values < [0.9, 0.25]).all() and (result.upper.values > [0.9, 0.25]).all()
    assert result.is_lower_bounded.all() and result.is_upper_bounded.all()
    assert result.attrs["p_value"] > 0.01


# ---- statements


def test_a_parameter_without_influence_is_reported() -> None:
    """The duration of a contact far below a period changes no loss, which a warning states; the restitution is found."""
    linear = rb.Linear(contact_time="20 us", restitution=0.5)
    path = "damper.contact.contact_time"
    result = calibrated(shaken(0.7), {**RANGES, path: ("10 us", "50 us")}, linear)
    assert result.lower[0] < 0.7 < result.upper[0]
    assert result.attrs["undetermined"] == [f"warning: the data do not depend on {path}: any value in its range fits"]
    assert result.lower[1].item() == pytest.approx(10e-6) and result.upper[1].item() == pytest.approx(50e-6)
    assert result.is_lower_bounded.values.tolist() == result.is_upper_bounded.values.tolist() == [True, False]
    figure = rb.plot_calibration(result.isel(parameter=[0, 1, 0]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of axes without room
        figure.savefig(BytesIO(), format="png")
    assert len(figure.axes) == 4


def test_parameters_that_act_together_are_told_apart_by_a_known_one() -> None:
    """Damping of structure and of damper at one amplitude have a determined sum alone; with one known, both are found."""
    ring = rung_down(0.7, ["0.7 mm", "0.8 mm"])
    ranges = {**RANGES, DAMPING: (0.0, 0.01)}
    together = calibrated(ring, ranges)
    text = " ".join(together.attrs["undetermined"])
    assert f"the data cannot separate {E} and {DAMPING}" in text and f"determined is {E} - " in text
    assert together.lower[0] < 0.7 < together.upper[0] and together.lower[1] <= 0.005 <= together.upper[1]
    known = calibrated(ring, ranges, known={DAMPING: ("0.5 %", "0.02 %")})
    assert known.attrs["undetermined"] == []
    assert known.lower[0] < 0.7 < known.upper[0]
    assert (known.upper - known.lower)[0] < 0.4 * (together.upper - together.lower)[0]
    assert json.loads(known.attrs["known"]) == {DAMPING: [0.005, pytest.approx(0.0002)]}
    for result, freedom in ((together, 0), (known, 1)):  # two ratios, perhaps a known value, and two parameters
        assert result.attrs["degrees_of_freedom"] == freedom
    assert known.attrs["p_value"] == pytest.approx(chi2.sf(known.attrs["chi2"], 1))
    assert np.isnan(together.attrs["p_value"])


def test_data_that_no_parameter_explains_are_reported() -> None:
    """Losses far above those of all restitutions give a warning that the intervals are not valid."""
    data = shaken(0.6)
    wrong = rb.ShakerLoss(LEVELS, "40 Hz", reduced_loss=data.loss * [1.0, 2.0, 0.5], error="3 %")
    assert "the intervals are not valid" in " ".join(calibrated(wrong).warnings)


def test_a_parameter_at_the_end_of_its_range_is_not_bounded() -> None:
    """If the planted value is outside of the range, the interval ends at the end of the range, and a warning states it."""
    result = calibrated(shaken(0.8), {E: (0.4, 0.75)})
    assert f"the data do not bound {E} above: its interval ends at the end of the range, 0.75" in " ".join(
        result.warnings
    )
    assert result.is_lower_bounded.item() and not result.is_upper_bounded.item()


# ---- coverage of the intervals


def fitted(planted: float, rise: float, rng: np.random.Generator) -> Fit:
    """Return the fit of two rounds of losses of random packings, whose scatter rises with the parameter, to noisy data."""
    mix = np.linalg.cholesky(0.5 * np.eye(3) + 0.5)

    def simulated(x: np.ndarray) -> np.ndarray:
        means = np.stack([1 + 1.5 * x, 2 - 1.2 * x + 0.5 * x**2, 1 + 0.5 * x], axis=1)
        scatter = 0.01 + rise * x[:, None]
        return means + scatter * (rng.standard_normal((x.size, 3)) @ mix.T)

    space = Space(["a"], ["1"], np.zeros(1), np.ones(1), np.zeros(1, bool), {})
    measured = simulated(np.array([planted]))[0]
    error = 0.02 * measured
    noisy = measured + error * rng.standard_normal(3)
    (low, high), points, values = space.corners, np.zeros((0, 1)), np.zeros((0, 3))
    for _ in range(2):
        new = low + (high - low) * rng.random((64, 1))
        points, values = np.concatenate([points, new]), np.concatenate([values, simulated(new[:, 0])])
        used = ((points >= low) & (points <= high)).all(axis=1)
        fit = Fit.of(space, (low, high), points[used], values[used], noisy, error, np.zeros(3, int))
        low, high = fit.narrowed()
    return fit


@pytest.mark.parametrize(("planted", "rise"), [(0.3, 0.0), (0.3, 0.15), (0.7, 0.15)])
def test_intervals_hold_the_planted_value_as_often_as_they_say(planted: float, rise: float) -> None:
    """95 % or more of the intervals hold the planted value, also if the scatter rises by a factor of 16 over the range."""
    rng, hits = np.random.default_rng(1), 0
    for _ in range(200):
        low, high = fitted(planted, rise, rng).limits[0]
        hits += bool(low <= planted <= high)
    assert hits / 200 >= 0.92  # 95 % less two standard deviations of 200 trials


# ---- budget and store


def test_the_budget_is_predicted_and_kept(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A prediction is printed; if it exceeds the budget nothing runs, and following the hint does."""
    data, time = shaken(0.7), 3.0

    def predict(work: CalibrationEngine) -> tuple[float, float]:
        return time, 1.0

    monkeypatch.setattr(CalibrationEngine, "predict", predict)
    options: dict[str, Any] = {"workers": 1, "progress": True, "checks": 2}
    with pytest.raises(
        rb.CaseError, match=r'budget = 2 s is less than predicted for at most 54 samples.*\n  try: budget = "7'
    ):
        calibrated(data, budget="2 s", **options)
    assert capsys.readouterr().err == ""
    calibrated(data, budget="8 s", **options)
    assert (
        "calibrate: at most 54 samples: about 6.2 s of processor time, 6.2 s with 1 worker" in capsys.readouterr().err
    )


def test_a_prediction_is_near_the_time_of_the_runs() -> None:
    """The processor time that is predicted is that of all samples within a factor of five."""
    grid = read_axes(case(), {"sample": {E: [0.7] * 12}})
    work = CalibrationEngine(case(), grid, [simulation_of(shaken(0.7), case())])
    predicted, _ = work.predict()
    before = process_time()
    work.run(range(12))
    assert 0.2 < (process_time() - before) / predicted < 5


def test_the_same_call_resumes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stopped calibration continues with the samples that are missing, and has the result of one without a stop."""
    data, store = shaken(0.7), tmp_path / "calibration"
    done = 0

    def stop(*_: int) -> bool:
        nonlocal done
        done += 1
        return done < 4

    with pytest.raises(Stopped):
        calibrated(data, store=store, progress=stop, workers=1)
    count, run = 0, CalibrationEngine.run

    def counted(work: CalibrationEngine, numbers: range, **options: Any) -> Any:
        nonlocal count
        count += len(numbers)
        return run(work, numbers, **options)

    monkeypatch.setattr(CalibrationEngine, "run", counted)
    resumed = calibrated(data, store=store, workers=1)
    assert 26 + 8 < count < 60
    count = 0
    again = calibrated(data, store=store, workers=1)
    assert count == 0
    monkeypatch.undo()
    whole = calibrated(data)
    for name in ("value", "lower", "upper", "simulated", "check"):
        np.testing.assert_array_equal(resumed[name], whole[name])
        np.testing.assert_array_equal(again[name], whole[name])
    np.testing.assert_array_equal(rb.open_study(store).value, whole.value)
    with pytest.raises(rb.StoreError):
        calibrated(data, store=store, seed=5)


# ---- errors

RING = {"amplitude": DECAYS, "damping_ratio": [0.02, 0.014, 0.011], "error": "3 %"}
LOSS = {"amplitude": LEVELS, "frequency": "40 Hz", "reduced_loss": [3.0, 1.6, 0.6], "error": "3 %"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"amplitude": ["1 mm"], "damping_ratio": [0.02]}, "one amplitude"),
        ({"amplitude": [], "damping_ratio": []}, "amplitude\n.*no value"),
        ({"amplitude": ["1 mm", "nan mm", "2 mm"]}, r"amplitude\[1\]"),
        ({"damping_ratio": [0.02, float("nan"), 0.01]}, r"damping_ratio\[1\]\n.*finite"),
        ({"damping_ratio": [0.02, -0.01, 0.01]}, r"damping_ratio\[1\]\n.*greater than zero"),
        ({"damping_ratio": [2.1, 1.4, 1.1]}, r'damping_ratio\[0\]\n.*\n.*try: "2.1 %"'),
        ({"damping_ratio": [0.02, 0.01]}, "3 amplitudes, but 2 damping ratios"),
        ({"amplitude": ["1 s", "2 s", "3 s"]}, r"amplitude\[0\]\n.*length"),
        ({"amplitude": ["1 mm", "1 mm", "3 mm"]}, "given twice"),
        ({"error": "0 %"}, "error.*\n.*greater than zero"),
        ({"error": [0.1, 0.1]}, "error\n.*2 values, but 3 are needed"),
        ({"error": 0.05}, "is not smaller than value 1"),
        ({"mode": 0}, "mode"),
    ],
)
def test_errors_of_ring_downs_name_the_value(changes: dict[str, Any], words: str) -> None:
    """Each wrong ring-down raises an error with the place and what is wrong."""
    with pytest.raises(rb.CaseError, match=words):
        rb.RingDown(**{**RING, **changes})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"reduced_loss": None}, "is needed"),
        ({"loss_factor": [0.1, 0.1, 0.1]}, "not both"),
        ({"error": None}, "uncertainty of the loss is needed"),
        ({"reduced_loss": [3.0, float("nan"), 0.6]}, r"reduced_loss\[1\]\n.*finite"),
        ({"reduced_loss": []}, "reduced_loss\n.*no value"),
        ({"amplitude": ["1 mm", "2 mm"]}, "amplitude\n.*2 values, but 3 are needed"),
        ({"amplitude": [1.0, 2.0, 3.0]}, "amplitude\n.*distinguishes a displacement from an acceleration"),
        ({"frequency": "40 m"}, "frequency\n.*frequency"),
        ({"reduced_loss": None, "loss_per_cycle": ["1 mm"] * 3}, r"loss_per_cycle\[0\]\n.*energy"),
        ({"cycles": (20, 0)}, "cycles"),
    ],
)
def test_errors_of_losses_name_the_value(changes: dict[str, Any], words: str) -> None:
    """Each wrong loss on a shaker raises an error with the place and what is wrong."""
    with pytest.raises(rb.CaseError, match=words):
        rb.ShakerLoss(**{**LOSS, **changes})


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"data": rb.ShakerLoss("1 mm", "40 Hz", reduced_loss=1.0, error="3 %")}, "1 measured value cannot determine"),
        ({"parameters": {"damper.friktion": (0, 1)}}, "damper.friktion"),
        ({"parameters": {E: (0.9, 0.4)}}, "the first value must be the smaller one"),
        ({"parameters": {E: (0.0, 0.4)}, "log": [E]}, "and above zero"),
        ({"parameters": {E: (0.4, 1.4)}}, rf"parameters: {E}\[1\]"),
        ({"parameters": {E: 0.4}}, "a pair"),
        ({"parameters": {E: (0.4, float("nan"))}}, E),
        ({"parameters": {}}, "parameters\n.*a mapping"),
        ({"parameters": None}, "parameters\n.*a mapping"),
        (
            {"parameters": {**RANGES, "damper.gap": ("1 mm", "2 mm"), DAMPING: (0, 0.1), "structure.mass": (1, 2)}},
            "at most 3",
        ),
        ({"budget": 0}, "budget\n.*0 s is not greater than zero"),
        ({"budget": "3 mm"}, "budget"),
        ({"runs": 10}, "runs = 10 are too few.*\n.*runs = 23 or more"),
        ({"checks": 1}, "checks"),
        ({"log": ["damper.gap"]}, "log"),
        ({"known": {"damper.gap": ("1 mm", "0.1 mm")}}, "known\n.*damper.gap"),
        ({"known": {E: 0.8}}, "known\n.*pair"),
        ({"known": {E: (0.8, 0)}}, "known.*\n.*not greater than zero"),
        ({"known": {E: ("0.8 mm", "1 mm")}}, "known"),
        ({"case": None}, "case\n.*need a case with a damper"),
        ({"case": case(damper=())}, "case\n.*need a case with a damper"),
        ({"data": [rb.ShakerLoss(**LOSS), rb.Drops("0.3 m", ["0.2 m"] * 2)]}, "not calibrated together"),
        ({"data": rb.RingDown(**RING, mode=2)}, "mode 2|mode = 2"),
        ({"data": rb.RingDown(**RING, point="tip")}, "tip"),
    ],
)
def test_errors_of_calls_name_the_argument(options: dict[str, Any], words: str) -> None:
    """Each wrong argument raises an error with its name and what is wrong."""
    usual = {"data": rb.ShakerLoss(**LOSS), "case": case(), "parameters": RANGES, "progress": False}
    with pytest.raises(rb.CaseError, match=words):
        rb.calibrate(**{**usual, **options})


def test_decays_that_end_too_early_are_refused() -> None:
    """If most decays of the case do not pass the amplitudes, the error names the duration."""
    with pytest.raises(
        rb.CaseError, match=r"26 of 26 samples have no simulated value.*0.4 mm.* 6 are needed\n  try: a longer duration"
    ):
        rb.calibrate(rb.RingDown(**RING), case(duration="0.1 s"), RANGES, runs=26, progress=False)


def test_logarithmic_ranges() -> None:
    """The middle of a logarithmic range is the geometric mean of its ends, and points follow from values again."""
    paths, log = ["damper.contact.restitution", "damper.friction"], np.array([False, True])
    space = Space(paths, ["1", "1"], np.array([0.2, 0.01]), np.array([0.8, 1.0]), log, {})
    points = np.array([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]])
    np.testing.assert_allclose(space.values(points), [[0.2, 0.01], [0.5, 0.1], [0.8, 1.0]], rtol=1e-14)
    np.testing.assert_allclose(space.points(space.values(points)), points, atol=1e-14)
