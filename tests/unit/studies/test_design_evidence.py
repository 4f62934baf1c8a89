"""Evidence of a design: damping curves of all trials, trials that cannot be told apart, amplitudes that do not decide."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox.cli.show import show_study
from rattlebox.report.kinds.design import KIND
from rattlebox.studies.design.candidate import added_mass
from rattlebox.studies.design.evidence import curves_of, order_note, with_order

NUMBER = "damper.number"


def shaken_bed(**changes: Any) -> rb.Case:
    """Return a structure with a box of a few balls."""
    damper: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=20),
        "cavity": rb.Box(size=("16 mm", "16 mm", "22 mm")),
        "contact": rb.Tsuji(restitution=0.6),
        "friction": 0.3,
        "direction": "z",
        "packing": rb.Settled(seed=1),
        "softening": 100,
    }
    return rb.Case(
        structure=rb.SDOF(mass="0.05 kg", frequency="100 Hz", damping_ratio=0.02),
        damper=rb.ParticleDamper(**damper | changes),
        duration="0.1 s",
    )


def searched(parameters: Any, amplitudes: list[str], objective: Any = "damping_ratio", **options: Any) -> xr.Dataset:
    """Return a short search by shaking."""
    usual: dict[str, Any] = {"way": "shaking", "cycles": (10, 10), "packings": 3, "progress": False}
    return rb.design(shaken_bed(), parameters, objective, amplitudes=amplitudes, **usual | options)


def test_the_curve_of_every_trial_is_that_of_the_damping_curve() -> None:
    """Each trial has its damping curve with interval, at each level; before, only the least value of it was kept."""
    amplitudes = ["1 mm", "2 mm"]
    levels = {"damper.gravity": [[0, 0, -9.81], [-9.81, 0, 0]]}
    result = searched({NUMBER: [1, 2]}, amplitudes, levels=levels or None)
    for trial, number in enumerate((1, 2)):
        for level, gravity in enumerate(levels["damper.gravity"]):
            case = shaken_bed(number=number, gravity=gravity)
            curve = rb.damping_curve(case, amplitudes, way="shaking", cycles=(10, 10), packings=3, progress=False)
            one = result.isel(trial=trial, level=level)
            assert np.array_equal(
                one.damping_curve_packings.values, curve.damping_ratios.transpose(*("amplitude", "packing"))
            )
            assert one.damping_curve.values == pytest.approx(curve.damping_ratio.values, rel=1e-12)
            assert one.damping_curve_interval.values == pytest.approx(
                (curve.upper - curve.lower).values / 2, rel=1e-9, nan_ok=True
            )
            assert float(one.bare) == 0.02
            drawn = list(curves_of(result, [trial]).values())[level]
            assert drawn.upper.values == pytest.approx(curve.upper.values, rel=1e-9, nan_ok=True)
    worst = result.damping_curve_packings.min(["level", "amplitude"])
    assert np.array_equal(worst.mean("packing").values, result.damping_ratio.values)
    assert str(result.level.values[1]).startswith("damper.gravity = [-9.81")


def test_a_trial_without_all_values_keeps_its_curve() -> None:
    """A trial whose decays do not pass all amplitudes is not feasible, and its curve has the values that are known."""
    case = shaken_bed()
    with pytest.warns(UserWarning, match="no trial is feasible"):
        result = rb.design(
            case, {NUMBER: [1]}, "damping_ratio", amplitudes=["1 um", "0.2 mm", "0.25 mm"], packings=2, progress=False
        )
    assert not result.feasible.any()
    assert np.isfinite(result.damping_curve.values[0])[[0, -1]].tolist() == [False, True]


def test_the_structure_alone_decides_at_a_small_amplitude(tmp_path: Path) -> None:
    """A bed that is locked at the worst amplitude is stated; before, the scatter of locked beds made a ranking."""
    with pytest.warns(
        UserWarning, match=r"at 10 µm \(0\.403 g\), which decides.*2 of 2 trials.*structure alone \(2 %\)"
    ):
        result = searched({NUMBER: [1, 2]}, ["10 um", "2 mm"], store=tmp_path / "design")
    assert result.bare_decides.all()
    rb.write_report(result, tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8").count("which decides as the worst amplitude") == 1
    large = searched({NUMBER: [1, 2]}, ["1 mm", "2 mm"])
    assert not large.bare_decides.any() and "warnings" not in large.attrs
    mean = searched({NUMBER: [1, 2]}, ["10 um", "2 mm"], robust="mean")
    assert "bare_decides" not in mean and "warnings" not in mean.attrs


def test_trials_that_cannot_be_told_apart_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Result, report and `rattlebox show` name the trials whose intervals overlap that of the best, and draw the curves."""
    parameters = {"damper.friction": [0.3, 0.31, 0.32], NUMBER: [1, 4]}
    result = searched(parameters, ["1 mm", "2 mm"], store=tmp_path / "design")
    best, half = result.damping_ratio.values, result.damping_ratio_interval.values
    first = int(result.front.item())
    overlap = best + half > best[first] - half[first]
    assert np.array_equal(result.may_be_best.values, overlap) and 1 < overlap.sum() < 6
    order = result.attrs["order"]
    assert order.startswith(f"the best {overlap.sum()} of 6 trials cannot be told apart: the 95 % intervals of trial")
    assert f"that of trial {first}" in order
    show_study(tmp_path / "design")
    assert "cannot be told apart" in " ".join(capsys.readouterr().out.split())
    assert any("cannot be told apart" in line for line in KIND.answer(result))
    table = list(KIND.tables(result))[-1]
    assert table.title == "Damping ratio over the amplitude" and len(table.rows) == 6
    assert table.header == ("trial", "1 mm (40.3 g)", "2 mm (80.5 g)", "structure alone")
    assert sum("±" in cell for row in table.rows for cell in row) == np.isfinite(result.damping_curve_interval).sum()
    *_, picture = KIND.pictures(result)
    figure = picture.draw()
    figure.savefig(tmp_path / "curves.png")
    assert figure.axes[0].child_axes[0].get_xlabel() == "Acceleration (g)"  # amplitudes were lengths only


def test_amplitudes_in_g_need_one_structure() -> None:
    """Amplitudes in g are refused where parameters or levels change the structure; only numbers of it as parameters were."""
    stiffer = rb.SDOF(mass="0.05 kg", frequency="200 Hz", damping_ratio=0.02)
    for parameters, levels in (
        ({"structure.frequency": [100, 200]}, {}),
        ({"structure": [shaken_bed().structure, stiffer]}, {}),
        ({NUMBER: [1, 2]}, {"structure.frequency": [100, 200]}),
    ):
        with pytest.raises(rb.CaseError, match="change the structure"):
            searched(parameters, ["20 g", "60 g"], levels=levels or None)
        assert "frequency" not in searched(parameters, ["1 mm", "2 mm"], levels=levels or None, packings=1).attrs


def planted(values: Any, half: Any, front: list[int], goals: tuple[str, ...]) -> xr.Dataset:
    """Return a result with given objectives and half widths, (trials, objectives)."""
    found = xr.Dataset({"feasible": ("trial", np.ones(len(values), bool)), "front": ("front", front)})
    for k, goal in enumerate(goals):
        found[f"f{k}"] = "trial", np.array(values, float)[:, k], {"goal": goal}
        found[f"f{k}_interval"] = "trial", np.array(half, float)[:, k]
    return found.assign_coords(packing=[0, 1])


def test_the_front_is_open_within_intervals() -> None:
    """A trial is excluded from the front only if one on it is better in all objectives beyond both intervals."""
    found = planted([[3], [2.9], [1]], [[0.1], [0.1], [0.1]], [0], ("max",))
    found = with_order(found, [-1.0])
    assert found.may_be_best.values.tolist() == [True, True, False]
    assert order_note(found).startswith("the best 2 of 3 trials cannot be told apart")
    two = planted([[1, 5], [2, 2], [3, 2.1], [4, 4]], [[0, 0.3], [0, 0.3], [0, 0.3], [0, 0.3]], [0, 1], ("min", "min"))
    two = with_order(two, [1.0, 1.0])
    assert two.may_be_best.values.tolist() == [True, True, True, False]
    assert order_note(two) == (
        "trial 2 is not certainly worse than the Pareto front: the 95 % intervals overlap; try: more packings"
    )
    apart = with_order(planted([[3], [1]], [[0.1], [0.1]], [0], ("max",)), [-1.0])
    assert order_note(apart) == ""


def test_a_best_value_at_an_end_is_stated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The best gap at an end of its list or range has a remark; before, nothing distinguished such a trial from an optimum.

    Tests of designs looked at optima inside the values only. A limit that no case can exceed, names, a limit of the mass,
    and a best value in the middle have no remark.
    """
    base = rb.reference_case(rb.Tsuji(restitution=0.6), duration=0.1)
    gap, start, radius = "damper.gap", "damper.start", "damper.ball.radius"

    def nearest_to(path: str, best: float, values: Any, **options: Any) -> xr.Dataset:
        """Return a search for the value of a parameter that is next to a given one."""
        name = path.rpartition(".")[2]

        def objective(run: rb.Run) -> float:
            (damper,) = run.case.impact_dampers
            return abs(float(getattr(damper.balls[0] if name == "radius" else damper, name)) - best)

        return rb.design(base, {path: values}, objective, progress=False, **options)

    low = nearest_to(gap, 0.0, ["0.3 mm", "0.4 mm", "0.6 mm"], store=tmp_path / "design")
    note = "the best damper gap, 0.3 mm, is the smallest value tried; try: a smaller damper gap"
    assert low.attrs["at_end"] == note and f" {note[:50]}" in str(low)
    assert f"T{note[1:]}." in list(KIND.answer(low))
    show_study(tmp_path / "design")
    assert note in " ".join(capsys.readouterr().out.split())
    high = nearest_to(gap, 1.0, ["0.3 mm", "0.6 mm"])
    assert high.attrs["at_end"].startswith("the best damper gap, 0.6 mm, is the largest value tried")
    near = nearest_to(gap, 0.0, ("0.3 mm", "3 mm"), trials=30)
    assert "the smallest value of its range, 0.3 mm; try: a smaller damper gap" in near.attrs["at_end"]
    heaviest = added_mass(base.replaced({radius: "20 mm"}))
    for other in (
        nearest_to(gap, 0.4e-3, ["0.3 mm", "0.4 mm", "0.6 mm"]),
        nearest_to(gap, 0.0, ["0.3 mm"]),
        nearest_to(start, 1.0, [-1.0, 0.0, 1.0]),
        nearest_to(radius, 1.0, ["10 mm", "20 mm"], max_added_mass=1.0001 * heaviest),
        rb.design(base, {"damper.ball.material": ["steel", "brass"]}, "impact_share", progress=False),
    ):
        assert "at_end" not in other.attrs
    assert "at_end" in nearest_to(radius, 1.0, ["10 mm", "20 mm"]).attrs
