"""Stops in cases: fields, files, refusals with advice that works, notes, results, pictures and reports."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.plots.case import plot_case

SOFT = rb.Linear(stiffness="0.5 MN/m", restitution=0.6)
TOML = """
duration = "0.4 s"

[structure]
kind = "sdof"
mass = "3 kg"
frequency = "7 Hz"
velocity = "0.2 m/s"

[[stops]]
gap = "2 mm"
side = "both"
contact = { kind = "linear", stiffness = "0.5 MN/m", restitution = 0.6 }

[[stops]]
name = "bumper"
gap = "2.5 mm"
contact = { kind = "tsuji", restitution = 0.7 }
radius = "12 mm"
material = "steel"
wall = "rigid"
"""


def case(**options: Any) -> Any:
    """Return an oscillator that hits a stop on each side."""
    values: dict[str, Any] = {
        "structure": rb.SDOF(mass="3 kg", frequency="7 Hz", velocity="0.2 m/s"),
        "stop": rb.Stop(gap="2 mm", side="both", contact=SOFT),
        "duration": "0.4 s",
    }
    return rb.Case(**values | options)


def test_file_and_python_give_the_same_case(tmp_path: Path) -> None:
    """A case with stops is the same from TOML, from Python and from the file that it writes; so is its result."""
    read = rb.Case.from_toml(TOML)
    bumper = rb.Stop(
        name="bumper", gap="2.5 mm", contact=rb.Tsuji(restitution=0.7), radius="12 mm", material="steel", wall="rigid"
    )
    assert read == case(stop=[rb.Stop(gap="2 mm", side="both", contact=SOFT), bumper])
    read.to_file(tmp_path / "case.toml")
    assert rb.Case.from_file(tmp_path / "case.toml") == read
    run = rb.simulate(read)
    assert run.ok, run.message
    assert run.arrays.dampers == ("stop leading", "stop trailing", "bumper")
    run.save(tmp_path / "run.nc")
    assert rb.load(tmp_path / "run.nc").arrays == run.arrays
    assert set(run.impacts.damper.values.tolist()) == {0, 1}


@pytest.mark.parametrize(
    ("change", "words", "remedy"),
    [
        ({"stop": {"gap": "-1 mm", "contact": SOFT}}, "presses at rest", {"stop": {"gap": 0, "contact": SOFT}}),
        (
            {"stop": {"gap": "1 mm", "contact": rb.Tsuji(restitution=0.5)}},
            "follows from radius and material",
            {"stop": {"gap": "1 mm", "contact": rb.Tsuji(restitution=0.5), "radius": "20 mm", "material": "steel"}},
        ),
        (
            {"stop": {"gap": "1 mm", "contact": rb.Thornton(), "radius": "20 mm"}},
            "yield stress|follows from radius",
            {"stop": {"gap": "1 mm", "contact": rb.Thornton(), "radius": "20 mm", "material": "steel"}},
        ),
        ({"stop": {"gap": "1 mm", "contact": SOFT, "point": "tip"}}, "no point 'tip'", {}),
        ({"stop": {"gap": "1 mm", "contact": SOFT, "other": "mass"}}, "cannot meet itself", {}),
        ({"stop": {"gap": "1 mm", "contact": SOFT, "side": "left"}}, "leading", {}),
        (
            {"stop": {"gap": 0, "side": "both", "contact": SOFT}, "method": rb.Newton()},
            "need room",
            {"stop": {"gap": "1 um", "side": "both", "contact": SOFT}, "method": rb.Newton()},
        ),
        (
            {"structure": rb.SDOF(mass=3, frequency=7, displacement="2.5 mm")},
            "would start 0.5 mm inside",
            {"structure": rb.SDOF(mass=3, frequency=7, displacement="2 mm")},
        ),
        ({"structure": rb.Fixed()}, "does not move against a stop", {}),
        (
            {"stop": [rb.Stop(gap=1, contact=SOFT, name="a"), rb.Stop(gap=2, contact=SOFT, name="a")]},
            "called 'a'",
            {"stop": [rb.Stop(gap=1, contact=SOFT, name="a"), rb.Stop(gap=2, contact=SOFT, name="b")]},
        ),
    ],
)
def test_wrong_stops_are_refused_with_advice(change: dict[str, Any], words: str, remedy: dict[str, Any]) -> None:
    """Each wrong stop is refused by name, and the case that the advice names runs."""
    with pytest.raises(rb.CaseError, match=words) as error:
        case(**change)
    assert "stop" in str(error.value) or "point" in str(error.value)
    assert rb.simulate(case(**remedy)).ok


def test_stops_with_particles_are_refused() -> None:
    """A case with particles and a stop is refused by name."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="4 mm", count=3),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.5),
        direction="z",
    )
    with pytest.raises(rb.CaseError, match="with impact dampers, not with particle dampers"):
        case(damper=damper)


def test_computations_without_stops_refuse_them_by_name() -> None:
    """Damping curves, and steppers of a damper alone, name the stops that they do not know."""
    driven = case(load=rb.Harmonic(amplitude=5.0, frequency=7.0))
    for call in (
        lambda: rb.Stepper(driven, alone=True),
        lambda: rb.damping_curve(driven, amplitudes=["1 mm", "2 mm"]),
    ):
        with pytest.raises(rb.CaseError, match="but the case has 1 stop"):
            call()


def test_linear_analyses_refuse_stops() -> None:
    """Stability lobes and apparent masses of a case with stops are refused: they left the stops out without a word."""
    held = rb.Case(
        structure=rb.SDOF(mass="3 kg", frequency="90 Hz", damping_ratio=0.02),
        stop=rb.Stop(gap="1 mm", contact=SOFT),
        duration="1 s",
    )
    with pytest.raises(rb.CaseError, match="but the case has 1 stop"):
        rb.stability_lobes(held, cutting_coefficient="1500 N/mm^2", directional_factor=0.6)
    with pytest.raises(rb.CaseError, match="but the case has 1 stop"):
        rb.analysis.apparent_mass(held, [10.0, 90.0])


def test_point_beside_a_point_that_moves_alike_is_refused() -> None:
    """Two points of a structure that always move together cannot meet."""
    structure = rb.Modal(frequencies=[9.0], damping_ratios=[0.01], shapes={"a": [1.0], "b": [1.0]})
    with pytest.raises(rb.CaseError, match="does not move relative to the point 'b'"):
        case(structure=structure, stop=rb.Stop(point="a", other="b", gap=1e-3, contact=SOFT))


@pytest.mark.parametrize("load", [{"base": "m/s^2"}, {"load": "N"}])
def test_a_stop_that_is_pressed_from_the_start_is_not_out_of_reach(load: dict[str, str]) -> None:
    """A hard stop that carries a steady force has no impact and no note, which tests of stops that are hit did not see."""
    (name, unit), *_ = load.items()
    steady = rb.Record(times=[0, 10], values=[-7.0, -7.0] if name == "base" else [14.0, 14.0], unit=unit)
    stop = rb.Stop(gap="0 mm", contact=rb.Linear(stiffness="2 MN/m", restitution=0.5))
    structure = rb.SDOF(mass="3 kg", frequency="4 Hz", damping_ratio=0.02)
    run = rb.simulate(
        rb.Case(structure=structure, stop=stop, method=rb.Newton(), duration="1 s", **{name: steady})  # type: ignore[arg-type]
    )
    assert run.arrays.impacts.time.size == 0
    assert not run.notes


def test_notes_say_which_limits_were_exceeded() -> None:
    """Deep overlaps, fast impacts, an extrapolated curve, a stop that is not reached and few modes have notes."""
    sized: dict[str, Any] = {"radius": "5 mm", "material": "steel"}
    deep = rb.Stop(gap="1 mm", contact=rb.Linear(stiffness="20 kN/m", restitution=0.5), **sized)
    assert any("overlaps in stop reach" in note for note in rb.simulate(case(stop=deep)).notes)
    table = rb.Tsuji(restitution=rb.Tabulated(speeds=[1e-3, 1e-2], values=[0.9, 0.5]))
    fast = rb.simulate(case(stop=rb.Stop(gap="1 mm", contact=table, **sized)))
    assert any("the table of restitution ends" in note for note in fast.notes)
    curve = rb.TabulatedNormal(overlap=["0 um", "1 um", "2 um"], force=["0 N", "20 N", "50 N"])
    for method in (rb.EventDriven(), rb.Newton()):
        run = rb.simulate(case(stop=rb.Stop(gap="1 mm", contact=curve), method=method))
        assert any("measured only up to" in note for note in run.notes), method
    far = rb.simulate(case(stop=rb.Stop(gap="30 mm", contact=SOFT)))
    assert any(note.startswith("note: no impact at stop (smallest gap 25.") for note in far.notes)
    beam = rb.Beam(length="0.3 m", width="20 mm", height="4 mm", material="steel", mode_count=2)
    push = rb.HalfSine(amplitude="80 N", duration="5 ms", point="tip")
    hard = case(structure=beam, stop=rb.Stop(point="tip", gap="1 mm", contact=SOFT), load=push, method=rb.Newton())
    assert any("number of modes" in note for note in rb.simulate(hard).notes)
    soft = rb.Stop(point="tip", gap="1 mm", contact=rb.Linear(stiffness="5 kN/m", restitution=0.9))
    run = rb.simulate(hard.replaced({"stops": [soft], "method": rb.EventDriven()}))
    assert len(run.arrays.impacts) and not any("number of modes" in note for note in run.notes)


def test_stop_and_impact_damper_act_in_one_case() -> None:
    """A ball, a tuned mass and stops on both are in one log, and each has its share of the loss."""
    run = rb.simulate(
        case(
            damper=rb.ImpactDamper(
                ball=rb.Sphere(diameter="20 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
            ),
            tuned_mass=rb.TunedMass(mass="0.1 kg", frequency="6.8 Hz", damping_ratio=0.02),
            stop=[
                rb.Stop(point="tuned mass", gap="3 mm", side="both", contact=SOFT),
                rb.Stop(point="mass", gap="4 mm", contact=SOFT),
            ],
            duration="2 s",
        )
    )
    assert run.ok, run.message
    shares = run.ledger.damper_share
    assert run.arrays.dampers == ("damper", "stop leading", "stop trailing", "stop2")
    assert (shares[:3] > 0).all()
    assert sum(shares) == pytest.approx(run.ledger.contact_share, rel=1e-12)
    assert run.arrays.contact_names(0) == ("trailing wall", "leading wall")
    assert run.arrays.contact_names(3) == ("stop",)


def test_gap_is_an_axis_of_studies() -> None:
    """Each variant of a sweep over the gap of a stop has the numbers of a run of that case alone."""
    driven = case(load=rb.Harmonic(amplitude=15.0, frequency=6.8), duration="1 s", output=rb.Output(rate=4000.0))
    names = ["impacts", "peak", "peak_acceleration", "impact_loss", "peak_interface_force", "peak_contact_force"]
    gaps = [0.5e-3, 1e-3, 1.7e-3, 40e-3]
    found = rb.sweep(driven, {"stops[0].gap": gaps}, measure=names, samples=4001)
    assert (found.status == 0).all()
    for number, gap in enumerate(gaps):
        run = rb.simulate(driven.replaced({"stop.gap": gap}))
        values = run.summary().values
        mine = found.isel({"stops[0].gap": number})
        assert int(mine.impacts) == len(run.arrays.impacts)
        assert float(mine.peak) == pytest.approx(np.abs(run.arrays.displacement).max(), rel=1e-9)
        assert float(mine.peak_acceleration) == pytest.approx(values["peak_acceleration[mass]"], rel=1e-6)
        assert float(mine.impact_loss) == pytest.approx(run.ledger.contact_loss[-1], rel=1e-9, abs=1e-15)
        log = run.arrays.impacts
        assert float(mine.peak_contact_force) == pytest.approx(log.peak_force.max(initial=0.0), rel=1e-9)
    with pytest.raises(rb.CaseError, match="inside the stop"):
        rb.sweep(
            driven.replaced({"structure.displacement": "1 mm"}), {"stops[0].gap": [2e-3, 0.5e-3]}, measure=["impacts"]
        )


def test_frequency_response_and_bifurcation_follow_a_stop() -> None:
    """A structure with a stop has a frequency response and a bifurcation diagram; far from the stop both are linear."""
    driven = case(
        structure=rb.SDOF(mass=3.0, frequency=7.0, damping_ratio=0.03),
        stop=rb.Stop(gap="1.5 mm", contact=SOFT),
        load=rb.Harmonic(amplitude=5.0, frequency=7.0),
    )
    response = rb.frequency_response(driven, frequencies=[4.0, 6.8, 7.4], cycles=(60, 8))
    linear = response.bare_amplitude.values.ravel()[0]
    assert response.amplitude.values.ravel()[0] == pytest.approx(linear, rel=1e-4)
    assert response.amplitude.values[..., 1].max() < 0.5 * response.bare_amplitude.values[..., 1].max()
    diagram = rb.bifurcation(driven, "stop.gap", [1.0e-3, 50e-3], cycles=(80, 8))
    assert (diagram.status == 0).all()
    hits = diagram.impacts_per_cycle.values
    assert hits[..., 0].min() > 0 == hits[..., 1].max()


def test_pictures_and_report_show_the_stops(tmp_path: Path) -> None:
    """The drawing of a case, the figure of the impacts and the report name the stops and their gaps."""
    run = rb.simulate(rb.Case.from_toml(TOML))
    texts = [text.get_text() for axes in plot_case(run.case).axes for text in axes.texts]
    assert "2 mm" in texts and "2.5 mm" in texts
    assert any("bumper: tsuji contact" in text for text in texts)
    figure = run.plot.impacts()
    assert any(text.get_text() == "stop" for legend in figure.legends for text in legend.get_texts())
    run.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "a stop on each side at 2 mm" in page
    assert "effective mass of the contact" in page
    two = rb.Matrices(M=np.eye(2), K=1e3 * np.eye(2), points={"left": 0, "right": 1}, velocity=[0.1, -0.1])
    pounding = case(structure=two, stop=rb.Stop(point="left", other="right", gap="1 mm", contact=SOFT))
    drawn = [text.get_text() for axes in plot_case(pounding, size="column").axes for text in axes.texts]
    assert {"left", "right", "1 mm"} <= set(drawn)
