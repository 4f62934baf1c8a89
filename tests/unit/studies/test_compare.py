"""Cases side by side, and the statistical error of steady motion in summaries."""

import math
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

STRUCTURE = rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping_ratio=0.01)


def case(**options: Any) -> rb.Case:
    """Return a structure under a harmonic force near its resonance."""
    usual: dict[str, Any] = {
        "structure": STRUCTURE,
        "load": rb.Harmonic(amplitude="20 N", frequency="10 Hz"),
        "duration": "20 s",
    }
    return rb.Case(**{**usual, **options})


def test_compare_simulates_cases_and_takes_runs() -> None:
    """Reductions are those of the values; an earlier run of the same case gives the same column."""
    tuned = case(tuned_mass=rb.TunedMass.den_hartog(STRUCTURE, mass="1 kg"))
    result = rb.compare({"bare": case(), "tuned": tuned, "again": rb.simulate(tuned)})
    bare, one, again = (result.values[name] for name in ("bare", "tuned", "again"))
    assert one["rms_displacement[mass]"] == again["rms_displacement[mass]"]
    assert one["rms_reduction[mass]"] == pytest.approx(
        1 - one["rms_displacement[mass]"] / bare["rms_displacement[mass]"]
    )
    assert one["peak_reduction[mass]"] > 0.8 and "rms_reduction[mass]" not in bare
    assert list(result.runs) == ["bare", "tuned", "again"]
    assert "TMD" not in str(result) and "tuned" in str(result)
    assert rb.plot_comparison(result.runs).axes


def tower(**options: Any) -> rb.Case:
    """Return a building of nine storeys that is shaken for three seconds."""
    return rb.Case(
        structure=rb.ShearBuilding(masses=["90 t"] * 9, stiffnesses=["120 MN/m"] * 9, damping_ratio=0.03),
        base=rb.Harmonic(amplitude="0.08 g", frequency="1.1 Hz"),
        duration="3 s",
        output=rb.Output(rate="100 Hz"),
        **options,
    )


def test_table_of_a_building_fits_a_page() -> None:
    """Nine storeys and five runs give 50 lines of 150 letters with the largest drift; the other tests have one point."""
    tuned = [tower(tuned_mass=rb.TunedMass(mass=f"{k} t", frequency="0.9 Hz", point="storey 9")) for k in range(1, 7)]
    result = rb.compare({"bare": tower()} | {f"{k + 1} t": each for k, each in enumerate(tuned)})
    lines = str(result).splitlines()
    assert len(lines) <= 50 and max(map(len, lines)) <= 150
    assert sum("too short" in line for line in lines) == 1
    assert any("lines of one point are those of storey 9" in line for line in lines)
    drifts = [abs(result.runs["2 t"].motion.displacement.sel(point="storey 1"))] + [
        abs(rb.analysis.drift(result.runs["2 t"], f"storey {k + 1}", f"storey {k}")) for k in range(1, 9)
    ]
    assert result.values["2 t"]["largest_drift"] == max(float(drift.max()) for drift in drifts)
    assert any(line.startswith("largest drift of all storeys") for line in lines)
    assert not any(line.startswith("peak drift") for line in lines)


def test_notes_are_stated_once() -> None:
    """A note that several runs share is one line with their names."""
    ball = rb.Sphere(radius="60 cm", material="steel")
    wide = tower(damper=rb.ImpactDamper(ball=ball, gap="1 cm", contact=rb.Tsuji(restitution=0.5), point="storey 2"))
    result = rb.compare({"a": wide, "b": wide.replaced({"damper.gap": "2 cm"}), "c": tower()})
    (line,) = [line for line in str(result).splitlines() if "m wide" in line]
    assert line.startswith("a, b: ")


def test_settling_times_are_those_to_the_peak_of_the_first_run() -> None:
    """Struck structures are compared by one band, so that a heavier one does not settle sooner by its smaller peak."""
    pulse = rb.HalfSine(amplitude="4 kN", duration="1.5 ms")
    struck = {
        name: case(load=pulse, duration="3 s", structure=rb.SDOF(mass=mass, stiffness="90 kN/m", damping_ratio=0.03))
        for name, mass in (("light", "20 kg"), ("heavy", "29 kg"))
    }
    result = rb.compare({**struck, "short": struck["light"].replaced({"duration": "0.6 s"})})
    peak = result.values["light"]["peak_displacement[mass]"]
    for name in ("light", "heavy"):
        motion = result.runs[name].motion
        expected = rb.analysis.settling_time(motion.time, motion.displacement.sel(point="mass"), reference=peak)
        assert result.values[name]["settling_time[mass]"] == expected
    assert math.isnan(result.values["short"]["settling_time[mass]"])
    (row,) = [line for line in str(result).splitlines() if line.startswith("settles to 5 % of the peak")]
    assert row.endswith("not reached")
    assert "settling_time[mass]" not in rb.compare({**struck, "driven": case()}).values["light"]


def test_steady_values_carry_an_interval() -> None:
    """The RMS of the second half of a driven run lies within its interval of the exact one; a short run has none."""
    omega, k, m = 20 * math.pi, 80e3, 20.0
    exact = 20 / math.hypot(k - m * omega**2, 2 * 0.01 * math.sqrt(k * m) * omega) / math.sqrt(2)
    values = rb.simulate(case(duration="40 s", output=rb.Output(rate="500 Hz"))).summary().values
    error = float(values["steady_rms_displacement_error[mass]"])
    assert abs(float(values["steady_rms_displacement[mass]"]) - exact) < error < 0.1 * exact
    damping = 2 * 0.01 * math.sqrt(k * m)
    for key, expected in (
        ("rms_acceleration{}[mass]", omega**2 * exact),
        ("loss_power{}", damping * (omega * exact) ** 2),
    ):
        error = float(values[f"steady_{key.format('_error')}"])
        assert abs(float(values[f"steady_{key.format('')}"]) - expected) < error < 0.1 * expected
    short = rb.simulate(case(duration="0.05 s")).summary()
    assert math.isnan(float(short.values["steady_rms_displacement_error[mass]"]))
    assert "too short" in str(short)
    decay = rb.simulate(case(load=rb.HalfSine(amplitude="5 kN", duration="1 ms"))).summary()
    assert "steady_rms_displacement[mass]" not in decay.values


def test_accelerations_and_the_force_on_the_base() -> None:
    """The summary has the RMS of the absolute acceleration and of the force on a moving base."""
    moved = case(load=(), base=rb.Harmonic(amplitude="1 m/s^2", frequency="8 Hz"), output=rb.Output(rate="2 kHz"))
    run = rb.simulate(moved)
    values, motion = run.summary().values, run.motion
    absolute = float(np.sqrt((motion.absolute_acceleration.sel(point="mass") ** 2).mean()))
    assert values["rms_acceleration[mass]"] == pytest.approx(absolute, rel=5e-3)
    assert values["rms_interface_force"] == pytest.approx(float(np.sqrt((motion.interface_force**2).mean())), rel=1e-3)


@pytest.mark.parametrize("cases", [{}, case(), {"bare": 3}])
def test_bad_input(cases: Any) -> None:
    """Arguments other than cases by name are refused."""
    with pytest.raises(rb.CaseError):
        rb.compare(cases)
