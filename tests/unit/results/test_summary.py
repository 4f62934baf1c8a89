"""Numbers and text of the summary of a run."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest

import rattlebox as rb
from rattlebox import analysis
from rattlebox._util.quantities import digits, quantity
from rattlebox.results import Run, RunArrays, compare


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.00041234, "m", "0.4123 mm"),
        (0.000041234, "m", "41.23 µm"),
        (0.93024, "Hz", "0.9302 Hz"),
        (31415.0, "Hz", "31.41 kHz"),
        (1.2e6, "kg", "1200 t"),
        (12.0, "kg", "12.00 kg"),
        (0.25, "kg", "250.0 g"),
        (1056.0, "m/s^2", "1056 m/s^2 (107.7 g)"),
        (0.0123, "m/s^2", "0.01230 m/s^2"),
        (2500.0, "m/s", "2500 m/s"),
        (0.009986, "kg^0.5 m", "0.009986 kg^0.5 m"),
        (7850.0, "kg/m^3", "7850 kg/m^3"),
        (3e-6, "m^2", "3.000e-06 m^2"),
        (2.5e-6, "m/N", "2.500 µm/N"),
        (961.0, "(m/s^2)^2/Hz", "961.0 (m/s^2)^2/Hz"),
        (0.0, "m", "0 m"),
        (-1964.7, "N", "-1.965 kN"),
        (0.99996, "m", "1.000 m"),
        (999.96e-6, "m", "1.000 mm"),
        (1e-15, "J", "0.001000 pJ"),
        (5e13, "N", "50.00 TN"),
        (0.05417, "%", "5.417 %"),
        (-3.276e-179, "%", "0 %"),
        (1.5e-12, "%", "1.500e-10 %"),
        (0.99117, "1", "0.9912"),
        (12345.6, "", "12346"),
        (1.5e9, "", "1.500e+09"),
        (float("nan"), "N", "-"),
        (float("inf"), "N", "inf N"),
    ],
)
def test_quantities(value: float, unit: str, text: str) -> None:
    """Numbers are written with four digits and the prefix that fits after rounding."""
    assert quantity(value, unit) == text


def test_lengths_and_times_that_engineers_write() -> None:
    """Lengths from 0.1 mm to 1 m are in mm, times from 0.1 ms to 0.1 s in ms; smaller ones have numbers from 1 on."""
    lengths = {4e-5: "40.00 µm", 4e-4: "0.4000 mm", 0.397: "397.0 mm", 0.999996: "1.000 m", 1.2e-7: "120.0 nm"}
    times = {1.5e-7: "150.0 ns", 2e-4: "0.2000 ms", 0.05: "50.00 ms", 0.0999996: "0.1000 s", 0.5: "0.5000 s"}
    assert [quantity(value, "m") for value in lengths] == list(lengths.values())
    assert [quantity(value, "s") for value in times] == list(times.values())
    assert digits(2.0, 2) == "2.0"


def test_numbers_of_a_hand_made_run() -> None:
    """Peaks, root mean square at uneven times, and counts are those computed by hand."""
    arrays = RunArrays(
        time=np.array([0.0, 1.0, 4.0]),
        points=("tip",),
        mode_frequency=np.array([1.0]),
        displacement=np.array([[0.0], [2.0], [-4.0]]),
        load_work=np.array([0.0, 1.0, 2.0]),
        viscous_loss=np.array([0.0, 1.0, 2.0]),
    )
    values = Run(arrays, wall_time=0.25).summary().values
    assert values["peak_displacement[tip]"] == 4.0
    assert values["rms_displacement[tip]"] == np.sqrt((0.5 * 4 * 1 + 0.5 * (4 + 16) * 3) / 4)
    assert values["share_viscous"] == 1.0
    assert values["supplied_energy"] == 2.0
    assert values["computing_time"] == 0.25
    assert values["impacts"] == 0
    assert np.isnan(values["peak_contact_force"])


def test_the_summary_of_many_points_shows_the_largest_motions() -> None:
    """For nine points the table has all peaks, but RMS values of the points with the largest peaks only."""
    time = np.linspace(0.0, 1.0, 5)
    peaks = np.array([1.0, 9.0, 2.0, 8.0, 3.0, 7.0, 4.0, 6.0, 5.0])
    names = tuple(f"p{k}" for k in range(9))
    run = Run(RunArrays(time=time, points=names, mode_frequency=[1.0], displacement=np.outer(time, peaks)))
    table = str(run.summary())
    assert [name for name in names if f"peak displacement, {name}" in table] == list(names)
    assert [name for name in names if f"RMS displacement, {name}" in table] == ["p1", "p3", "p5", "p7"]
    legend = run.plot.motion().axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["p1", "p3", "p5", "p6", "p7", "p8"]


def _swinging(*peaks: float) -> Run:
    """Return a run of a structure with the given peaks at its points."""
    time = np.linspace(0.0, 1.0, 5)
    names = tuple(f"p{k}" for k in range(len(peaks)))
    return Run(RunArrays(time=time, points=names, mode_frequency=[1.0], displacement=np.outer(time, peaks)))


@pytest.mark.parametrize(
    ("peaks", "shown"),
    [
        ((0.0, 1e-3, 3e-20, 2e-3), ["p1", "p3"]),
        ((0.0, 1e-3, 0.0), ["p1"]),
        ((1e-3, 1e-11), ["p0", "p1"]),
        ((0.0, 0.0), ["p0", "p1"]),
        ((1e-20, 0.0, 2e-20), ["p0", "p2"]),
        ((np.nan, 0.0, 1e-3), ["p0", "p2"]),
    ],
)
def test_points_at_rest_are_omitted(peaks: tuple[float, ...], shown: list[str]) -> None:
    """Table and legend omit points that move by rounding only, unless all do; the values have all points."""
    run = _swinging(*peaks)
    summary = run.summary()
    names = [f"p{k}" for k in range(len(peaks))]
    for label in ("peak displacement", "RMS displacement"):
        assert [name for name in names if f"{label}, {name}" in str(summary)] == shown
    assert all(f"peak_displacement[{name}]" in summary.values for name in names)
    legend = run.plot.motion().axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == shown


def test_a_point_that_moves_in_one_of_several_runs_is_compared() -> None:
    """A comparison omits a point only if it is at rest in all runs."""
    table = str(compare({"a": _swinging(1e-3, 0.0, 0.0), "b": _swinging(0.0, 1e-3, 0.0)}))
    assert [name for name in ("p0", "p1", "p2") if f"peak displacement, {name}" in table] == ["p0", "p1"]


def test_numbers_of_a_run(run: Run) -> None:
    """The summary has the largest force and speed of the impact log and shares that add up to one."""
    values = run.summary().values
    assert values["impacts"] == len(run.arrays.impacts)
    assert values["peak_contact_force"] == run.arrays.impacts.peak_force.max()
    assert values["largest_approach_speed"] == run.arrays.impacts.approach_speed.max()
    assert abs(sum(values[f"share_{c}"] for c in ("viscous", "normal", "plastic", "motion")) - 1) < 1e-12
    assert values["energy_residual"] == run.energy_residual


def test_losses_of_several_dampers() -> None:
    """The summary has the energy share of each damper, or of the dampers with the largest shares if there are many."""
    lost = np.array([0.1, 0.0, 0.4, 0.2, 0.05, 0.15])

    def summary_of(count: int) -> str:
        names = tuple(f"d{k}" for k in range(count))
        loss = np.outer([0.0, 1.0], lost[:count])
        run = Run(RunArrays(time=[0.0, 1.0], dampers=names, load_work=[0.0, 2.0], normal_loss=loss))
        assert run.ledger.damper_share == pytest.approx(lost[:count] / 2)
        return str(run.summary())

    assert "lost in d" not in summary_of(1)
    assert re.findall(r"lost in (d\d) +(\S+)", summary_of(6)) == [
        ("d0", "5.000"), ("d2", "20.00"), ("d3", "10.00"), ("d5", "7.500")
    ]  # fmt: skip


def test_hard_impacts_have_no_force(run: Run) -> None:
    """The largest force of an impact log ignores NaN; without any force the table has a dash."""
    log = run.arrays.impacts
    force = log.peak_force.copy()
    force[:-1] = np.nan
    some = Run(run.arrays.replaced(impacts=log.replaced(peak_force=force)))
    assert some.summary().values["peak_contact_force"] == log.peak_force[-1]
    none = Run(run.arrays.replaced(impacts=log.replaced(peak_force=np.full(len(log), np.nan))))
    line = next(text for text in str(none.summary()).splitlines() if text.startswith("peak contact force"))
    assert line.split()[-1] == "-"


def test_plain_text(any_run: Run) -> None:
    """The text of every kind of run has aligned columns and no colours."""
    text = str(any_run.summary())
    assert "\x1b" not in text
    assert "impacts" in text
    assert "nan" not in text
    rows = text.splitlines()[:-1] if any_run.message else text.splitlines()
    assert len({len(row) for row in rows}) == 1
    assert ("displacement" in text) == bool(any_run.arrays.mode_frequency.size)


def test_the_message_of_a_run_is_in_the_summary(make_run) -> None:
    """The message of an interrupted run is printed below its table."""
    stopped = make_run(duration=0.01, times=11, status="interrupted", message="Stopped by hand [at 3].")
    assert str(stopped.summary()).endswith("Stopped by hand [at 3].")


def test_an_energy_error_is_reported() -> None:
    """Fixed steps too long for the contacts end a run with a status whose message the summary prints."""
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="1 kN/m"),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="1 mm",
            velocity="0.1 m/s",
            contact=rb.Tsuji(restitution=0.9),
        ),
        duration="0.1 s",
    )
    for step, wrong in {"1 us": False, "30 us": True}.items():
        method = rb.TwoStep(dt_contact=step, dt_flight=step)
        run = rb.simulate(case.model_copy(update={"method": method}))
        assert run.ok is not wrong, (step, run.energy_residual)
        assert (run.message in str(run.summary())) is wrong


def test_overflow_gives_no_warning() -> None:
    """The summary of a motion with overflow raises no warning of NumPy."""
    arrays = RunArrays(
        time=np.array([0.0, 1.0]),
        points=("tip",),
        mode_frequency=np.array([1.0]),
        displacement=np.array([[0.0], [1e200]]),
        load_work=np.array([0.0, np.inf]),
        viscous_loss=np.array([0.0, np.inf]),
    )
    assert "peak displacement" in str(Run(arrays).summary())


def test_show_is_plain_outside_a_terminal(run: Run) -> None:
    """Output to a file has no frames and equals the text."""
    target = io.StringIO()
    run.summary().show(target)
    assert target.getvalue() == f"{run.summary()}\n"


def test_show_is_a_table_in_a_terminal(run: Run) -> None:
    """Output to a terminal is a framed table with the same numbers."""

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    target = Terminal()
    compare({"[red]a[1] :smile:": run}, "[bold]Title").show(target)
    assert "─" in target.getvalue()
    assert "[red]a[1] :smile:" in target.getvalue()
    assert "[bold]Title" in target.getvalue()
    assert "25.79 %" in target.getvalue()


def test_comparison_has_a_column_for_each_run(run: Run, make_run) -> None:
    """Runs with different points, dampers and statuses share one table, with a dash for a missing number."""
    fixed = make_run(fixed=True, ball_speed=0.2, status="interrupted", message="Stopped by hand.")
    table = compare({"free": run, "fixed": fixed}, "Two cavities")
    assert set(table.values) == {"free", "fixed"}
    lines = str(table).splitlines()
    assert lines[0] == "Two cavities"
    assert lines[1].split() == ["free", "fixed"]
    assert next(line for line in lines if line.startswith("peak displacement")).split()[-1] == "-"
    assert lines[-1] == "fixed: Stopped by hand."


def test_comparison_of_nothing() -> None:
    """A comparison without runs is refused."""
    with pytest.raises(ValueError, match="no run"):
        compare({})


def test_plastic_line_only_where_it_is_lost(run: Run) -> None:
    """The table has a line of plastic loss if a run has such a loss."""
    assert "plastic" not in str(run.summary())
    flowing = Run(run.arrays.replaced(plastic_loss=run.arrays.normal_loss / 2))
    assert "plastic" in str(compare({"a": run, "b": flowing}))


def test_drifts_of_storeys_are_listed() -> None:
    """The summary of a shear building has the peak drift of each storey, the displacement over that of the floor below."""
    tower = rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=["60 MN/m"] * 3, damping_ratio=0.02)
    run = rb.simulate(
        rb.Case(structure=tower, base=rb.HalfSine(amplitude="0.2 g", duration="0.3 s"), duration="2 s"), progress=False
    )
    values = run.summary().values
    for upper, lower in (("storey 1", None), ("storey 2", "storey 1"), ("storey 3", "storey 2")):
        expected = float(abs(analysis.drift(run, upper, lower)).max())
        assert values[f"peak_drift[{upper}]"] == pytest.approx(expected)
        assert f"peak drift, {upper}" in str(run.summary())


def test_a_slowly_loaded_building() -> None:
    """Under a slow force F at the top of a building, all storeys drift by F/k, modes move by phi F/w^2, the base feels F."""
    force, stiffness = 120e3, 60e6
    tower = rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=[stiffness] * 3, damping_ratio=0.05)
    load = rb.Harmonic(amplitude=force, frequency="0.02 Hz", point="storey 3")
    run = rb.simulate(rb.Case(structure=tower, load=load, duration="100 s"), progress=False)
    values = run.summary().values
    modes = tower.modes()
    expected = {f"peak_drift[storey {k}]": force / stiffness for k in (1, 2, 3)}
    for k, (shape, squared) in enumerate(zip(modes.shapes["storey 3"], modes.stiffness, strict=True), start=1):
        expected[f"peak_modal_displacement[mode {k}]"] = abs(shape) * force / squared
        expected[f"rms_modal_displacement[mode {k}]"] = abs(shape) * force / squared / np.sqrt(2)
    expected |= {"peak_interface_force": force, "rms_interface_force": force / np.sqrt(2)}
    expected["steady_rms_interface_force"] = force / np.sqrt(2)
    assert {key: values[key] for key in expected} == pytest.approx(expected, rel=2e-3)
    text = str(run.summary())
    assert "peak force on the base" in text and "RMS force on the base, second half" in text
