"""Shocks, sine sweeps and random vibration against formulas, and as they move structures in both engines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.signal import lsim

import rattlebox as rb
from rattlebox.model import signals
from rattlebox.model import units as units_module
from rattlebox.model.plausibility import plausibility_notes
from rattlebox.model.signals import Polyline, Signal

G = 9.80665
PULSES: dict[str, tuple[Signal, float]] = {
    "half sine": (rb.HalfSine(amplitude="3 N", duration=0.4, start=0.1), 2 / math.pi * 3 * 0.4),
    "terminal sawtooth": (rb.Sawtooth(amplitude="3 N", duration=0.4, start=0.1), 0.6),
    "initial sawtooth": (rb.Sawtooth(amplitude="3 N", duration=0.4, start=0.1, peak="initial"), 0.6),
    "trapezoid": (rb.Trapezoid(amplitude="3 N", duration=0.4, start=0.1, rise=0.1, fall=0.2), 3 * 0.25),
    "trapezoid with tenths": (rb.Trapezoid(amplitude="3 N", duration=0.4, start=0.1), 3 * 0.36),
    "rectangle": (rb.Trapezoid(amplitude="3 N", duration=0.4, start=0.1, rise=0), 1.2),
}


def test_shocks_have_their_corners() -> None:
    """Values at, between and around the corners of sawteeth and trapezoids."""
    t = [0.0, 0.0999, 0.1, 0.2, 0.4, 0.4999, 0.5, 0.6, 2.0]
    up, down = PULSES["terminal sawtooth"][0], PULSES["initial sawtooth"][0]
    np.testing.assert_allclose(up.evaluate(t), [0, 0, 0, 0.75, 2.25, 2.99925, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(down.evaluate(t), [0, 0, 3, 2.25, 0.75, 0.00075, 0, 0, 0], atol=1e-12)
    trapezoid = PULSES["trapezoid"][0]
    np.testing.assert_allclose(trapezoid.evaluate(t), [0, 0, 0, 3, 1.5, 0.0015, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(PULSES["rectangle"][0].evaluate(t), [0, 0, 3, 3, 3, 3, 0, 0, 0], atol=1e-12)


@pytest.mark.parametrize("name", PULSES)
def test_shocks_give_their_impulse(name: str) -> None:
    """A free mass has the velocity of the integral of the pulse, and the motion of its double integral, in the engine."""
    pulse, impulse = PULSES[name]
    case = rb.Case(structure=rb.SDOF(mass=2.0, stiffness=0.0), load=pulse, duration=1.0, output=rb.Output(rate=100))
    run = rb.simulate(case)
    assert run.arrays.velocity[-1, 0] == pytest.approx(impulse / 2, rel=1e-10)
    lever = quad(lambda t: (1 - t) * float(pulse.evaluate(t)), 0.1, 0.5, points=[0.2, 0.3, 0.14, 0.46])[0]
    assert run.arrays.displacement[-1, 0] == pytest.approx(lever / 2, rel=1e-7)
    assert run.energy_residual < 1e-9


@pytest.mark.parametrize("name", PULSES)
def test_shocks_move_the_base(name: str) -> None:
    """Velocity and displacement of the base are the integrals of the pulse, before, in and after it."""
    pulse = PULSES[name][0].model_copy(update={"unit": "m/s^2"})
    for end in (0.05, 0.3, 0.9):
        displacement, velocity, _ = pulse.motion(np.array([end]))
        points = [t for t in (0.1, 0.14, 0.2, 0.3, 0.46, 0.5) if t < end]
        assert velocity[0] == pytest.approx(
            quad(lambda t: float(pulse.evaluate(t)), 0, end, points=points)[0], abs=1e-9
        )
        twice = quad(lambda t, end=end: (end - t) * float(pulse.evaluate(t)), 0, end, points=points)[0]
        assert displacement[0] == pytest.approx(twice, abs=1e-9)


def test_shocks_reach_the_3d_engine_whole() -> None:
    """Between two steps nothing of a short pulse with jumps is lost: a cavity with one ball gets its impulse."""
    box = rb.ParticleDamper(
        particles=rb.Particles(count=1, diameter="10 cm", material="steel"),
        cavity=rb.Box(size=["9 m", "9 m", "9 m"]),
        contact=rb.Tsuji(restitution=0.5),
    )
    for pulse in (
        rb.Sawtooth(amplitude="3 N", duration=0.0123, start=0.1011),
        rb.Trapezoid(amplitude="3 N", duration=0.0123, start=0.1011, rise=0),
    ):
        case = rb.Case(structure=rb.SDOF(mass=2.0, stiffness=0.0), load=pulse, damper=box, duration=0.3)
        impulse = quad(lambda t, pulse=pulse: float(pulse.evaluate(t)), 0.1011, 0.1134)[0]
        assert rb.simulate(case).arrays.velocity[-1, 0] == pytest.approx(impulse / 2, rel=1e-6)


SWEEPS = {
    "up, octaves": (20.0, 2000.0, {"sweep_rate": "120 oct/min"}, math.log2(100) / 2),
    "down, octaves": (2000.0, 20.0, {"sweep_rate": "2 oct/s"}, math.log2(100) / 2),
    "up, decades": (10.0, 1000.0, {"sweep_rate": "30 dec/min"}, 4.0),
    "up, hertz": (20.0, 520.0, {"sweep_rate": "250 Hz/s"}, 2.0),
    "down, hertz": (520.0, 20.0, {"sweep_rate": "15000 Hz/min"}, 2.0),
    "by duration": (520.0, 20.0, {"duration": "2 s"}, 2.0),
}


@pytest.mark.parametrize("name", SWEEPS)
def test_sweeps_have_frequency_and_level(name: str) -> None:
    """Zero crossings follow the frequency, and every cycle has a first harmonic of the given amplitude."""
    first, last, rate, length = SWEEPS[name]
    sweep = rb.SineSweep(amplitude="2 g_0", first_frequency=first, last_frequency=last, start=0.25, **rate)
    assert sweep.length == pytest.approx(length, rel=1e-12)
    ends = sweep.frequency_at([0.0, 0.25, 0.25 + length, 99.0])
    np.testing.assert_allclose(ends, [first, first, last, last], rtol=1e-9)
    times, values = sweep.polyline()
    begins = times[1:-1][::32]  # of whole cycles
    assert times[-2] == pytest.approx(0.25 + length, abs=1 / min(first, last))
    periods = np.diff(begins)
    middle = sweep.frequency_at((begins[1:] + begins[:-1]) / 2)
    growth = np.abs(np.gradient(middle)) / middle  # of the frequency within a cycle
    np.testing.assert_array_less(np.abs(periods * middle - 1), 1e-9 + growth**2)
    for k in np.linspace(1, len(begins) - 2, 7).astype(int):
        phase = np.arange(32 * 64) / 64  # in points, uniform over a cycle
        drawn = sweep.evaluate(np.interp(1 + 32 * k + phase, np.arange(times.size, dtype=float), times))
        harmonic = 2 * np.mean(drawn * np.exp(-2j * np.pi * phase / 32))
        assert abs(harmonic) == pytest.approx(2 * G, rel=2e-5)
    assert np.abs(values).max() == pytest.approx(2 * G, rel=4e-3)
    np.testing.assert_array_equal(sweep.evaluate([0.2, times[-2] + 1e-9, 99.0]), 0)


def test_a_sweep_drives_a_structure_as_its_formula() -> None:
    """An oscillator swept through its resonance moves as under the exact sine of the growing phase."""
    mass, omega, ratio = 2.0, 2 * math.pi * 40.0, 0.01
    sweep = rb.SineSweep(amplitude="5 N", first_frequency=20.0, last_frequency=80.0, sweep_rate="1 oct/s")
    structure = rb.SDOF(mass=mass, frequency=40.0, damping_ratio=ratio)
    run = rb.simulate(rb.Case(structure=structure, load=sweep, duration=1.99, output=rb.Output(rate="20 kHz")))
    t = run.arrays.time
    phase = 2 * np.pi * 20.0 * (np.exp2(t) - 1) / math.log(2)
    system = ([[0, 1], [-(omega**2), -2 * ratio * omega]], [[0], [1 / mass]], [[1, 0]], [[0]])
    exact = lsim(system, 5.0 * np.sin(phase), t)[1]
    np.testing.assert_allclose(run.arrays.displacement[:, 0], exact, atol=2e-3 * np.abs(exact).max())
    assert t.size > 100


def test_levels_of_gevs() -> None:
    """The named densities have the overall levels of the standard, 14.1 and 10.0 g RMS."""
    assert rb.Random("gevs_qualification", 1.0).rms / G == pytest.approx(14.1, abs=0.05)
    assert rb.Random("gevs_acceptance", 1.0).rms / G == pytest.approx(10.0, abs=0.05)


@pytest.mark.parametrize(
    ("name", "rms"),
    [
        ("truck_vertical", "1.04"),
        ("truck_transverse", "0.204"),
        ("truck_longitudinal", "0.740"),
        ("minimum_integrity", "7.7"),
    ],
)
def test_named_levels_have_their_rms_values(name: str, rms: str) -> None:
    """The integral over the break points is the stated RMS value; points were not compared with the printed standard."""
    digits = len(rms.partition(".")[2])
    assert rb.Random(name, 1.0).rms / G == pytest.approx(float(rms), abs=0.5 * 10.0**-digits)


@pytest.mark.parametrize("slope", [0.0, -1.0, 2.0, -3.0])
def test_rms_of_a_density(slope: float) -> None:
    """The closed form of the root mean square is the integral of the density, and the mean square of a long signal."""
    psd = [(10.0, 1e-2), (40.0, 1e-2 * 4**slope), (100.0, 1e-2 * 4**slope)]
    random = rb.Random(psd, 60.0, unit="m/s^2", seed=4)
    area = quad(lambda f: 1e-2 * (f / 10) ** slope, 10, 40)[0] + 60 * 1e-2 * 4**slope
    assert random.rms == pytest.approx(math.sqrt(area), rel=1e-12)
    # The scatter of the mean square is about 1 / sqrt(bandwidth x duration).
    assert np.mean(random.values**2) == pytest.approx(random.rms**2, rel=4 / math.sqrt(20 * 60))


def test_random_vibration_is_gaussian() -> None:
    """Skewness and excess of a long signal are those of a normal distribution."""
    values = rb.Random([(100.0, 1.0), (1000.0, 1.0)], 20.0, seed=7).values
    values = values / values.std()
    assert np.mean(values**3) == pytest.approx(0, abs=0.05)
    assert np.mean(values**4) == pytest.approx(3, abs=0.1)


LOADS = {
    "random": '[base]\nkind = "random"\npsd = [["20 Hz", "0.001 g^2/Hz"], ["1 kHz", "0.01 g^2/Hz"]]\n'
    'duration = "60 ms"\nseed = 3\n',
    "gevs": '[base]\nkind = "random"\npsd = "gevs_acceptance"\nduration = "60 ms"\n',
    "sweep": '[base]\nkind = "sine_sweep"\namplitude = "5 g"\nfirst_frequency = "100 Hz"\nlast_frequency = "1 kHz"\n'
    'sweep_rate = "50 oct/s"\n',
    "sawtooth": '[base]\nkind = "sawtooth"\namplitude = "50 g"\nduration = "6 ms"\n',
    "trapezoid": '[base]\nkind = "trapezoid"\namplitude = "50 g"\nduration = "6 ms"\nrise = "1 ms"\n',
    "half sine": '[base]\nkind = "half_sine"\namplitude = "50 g"\nduration = "6 ms"\n',
}  # fmt: skip
BEAM = '[structure]\nkind = "beam"\nlength = "0.2 m"\nmaterial = "steel"\ndiameter = "20 mm"\n'
BEAM += "damping_ratio = 0.01\nmode_count = 1\n"
LAW = 'contact = { kind = "tsuji", restitution = 0.8 }\n'


@pytest.mark.parametrize("kind", LOADS)
def test_loads_in_case_files_and_both_engines(kind: str) -> None:
    """A case file reads back equal, and both engines give the structure the same motion."""
    head = f'duration = "50 ms"\n{BEAM}{LOADS[kind]}'
    line = f'[damper]\npoint = "tip"\nball = {{ diameter = "2 mm", material = "steel" }}\ngap = "0.1 mm"\n{LAW}'
    case = rb.Case.from_toml(head + line)
    again = rb.Case.from_toml(case.to_toml())
    assert again == case
    assert rb.Case.from_toml(again.to_toml()) == case
    box = (
        '[damper]\npoint = "tip"\ncavity = { kind = "box", size = ["2.2 mm", "3 mm", "3 mm"] }\n'
        'particles = { material = "steel", diameter = "2 mm", count = 1 }\ndirection = "x"\n'
        f'packing = {{ kind = "positions", positions = [[0, 0, 0]] }}\n{LAW}'
    )
    runs = [rb.simulate(case), rb.simulate(rb.Case.from_toml(head + box))]
    assert all(run.ok for run in runs)
    assert runs[0].energy_residual < 1e-9
    tip = [np.interp(np.linspace(0, 0.05, 200), run.arrays.time, run.arrays.displacement[:, 0]) for run in runs]
    np.testing.assert_allclose(tip[1], tip[0], atol=0.02 * np.abs(tip[0]).max())


def test_a_random_signal_must_cover_the_run() -> None:
    """A run longer than the signal is refused with the field to change."""
    with pytest.raises(rb.CaseError, match=r"base\.duration"):
        rb.Case(structure=rb.SDOF(mass=1.0, stiffness=1.0), base=rb.Random("gevs_acceptance", 1.0), duration=2.0)


def test_a_run_that_ends_within_a_sweep_says_so() -> None:
    """A run warns of a sweep that it does not finish, with the frequency that it reaches."""
    sweep = rb.SineSweep(amplitude="1 g", first_frequency=10.0, last_frequency=100.0, sweep_rate="45 Hz/s")
    case = rb.Case(structure=rb.SDOF(mass=1.0, frequency=20.0), base=sweep, duration=1.0)
    assert any("the run ends at 55 Hz" in note for note in plausibility_notes(case))
    assert not any("sweep" in note for note in plausibility_notes(case.replaced({"duration": 2.5})))


def test_loads_in_sweeps() -> None:
    """Amplitudes, seeds and rates are axes of studies."""
    case = rb.Case.from_toml(f'duration = "50 ms"\n{BEAM}{LOADS["random"]}[damper]\npoint = "tip"\n'
                             f'ball = {{ diameter = "2 mm", material = "steel" }}\ngap = "0.1 mm"\n{LAW}')  # fmt: skip
    seeds = rb.sweep(case, {"base.seed": [3, 4]}, measure=["impacts"], progress=False).impacts.values
    assert seeds[0] == len(rb.simulate(case).arrays.impacts)
    tooth = case.replaced({"base": rb.Sawtooth(amplitude="50 g", duration="6 ms")})
    result = rb.sweep(tooth, {"base.duration": ["6 ms", "3 ms"]}, measure=["largest_approach_speed"], progress=False)
    alone = rb.simulate(tooth).arrays.impacts.approach_speed.max()
    assert result.largest_approach_speed.values[0] == pytest.approx(alone, rel=1e-9)


def test_polylines_are_what_the_core_reads() -> None:
    """All signals of straight lines give the core rising times."""
    made: list[Any] = [signal for signal, _ in PULSES.values() if isinstance(signal, Polyline)]
    made += [
        rb.Random("gevs_acceptance", 0.1),
        rb.SineSweep(amplitude=1.0, first_frequency=9, last_frequency=3, duration=1),
    ]
    for signal in made:
        packed = signal.coefficients()
        assert packed["kind"] == "record" and (np.diff(packed["times"]) >= 0).all()
        assert packed["times"].shape == packed["values"].shape


@pytest.mark.parametrize("alone", [True, False])
def test_an_amplitude_is_read_once(alone: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The text of an amplitude is read once, alone or in a case; three places read it, each for a part of the result."""
    read = []

    def parse(value: Any, units: Any) -> Any:
        if isinstance(value, str):
            read.append(value)
        return units_module.parse(value, units)

    monkeypatch.setattr(signals, "parse", parse)
    load = {"kind": "half_sine", "amplitude": "3 kN", "duration": "2 ms"}
    structure = {"kind": "sdof", "mass": "2 kg", "frequency": "7 Hz"}
    signal = rb.HalfSine(**load) if alone else rb.Case(structure=structure, load=load, duration="1 s").loads[0]
    assert read == ["3 kN"]
    assert (signal.amplitude, signal.unit, type(signal.amplitude)) == (3000.0, "N", float)


@pytest.mark.parametrize(
    ("name", "peak", "duration"),
    [
        ("H 516.8 flight vehicle", 20, 0.011),
        ("H 516.8 weapon launch", 30, 0.011),
        ("H 516.8 ground", 40, 0.011),
        ("H 516.8 truck", 20, 0.011),
        ("F 516.5 crash, flight vehicle", 40, 0.011),
        ("F 516.5 crash, ground", 75, 0.006),
    ],
)
def test_named_shocks_of_a_standard(name: str, peak: float, duration: float) -> None:
    """A name is a terminal-peak sawtooth with the velocity of its area; it was not compared with the printed standard."""
    pulse = rb.Sawtooth.profile(f"MIL-STD-810{name}")
    assert (pulse.duration, pulse.peak, pulse.unit) == (duration, "terminal", "m/s^2")
    assert pulse.amplitude == pytest.approx(peak * 9.80665)
    free = rb.Case(structure=rb.SDOF(mass="1 kg", stiffness=0), base=pulse, duration="20 ms")
    run = rb.simulate(free)
    assert run.arrays.velocity[-1, 0] == pytest.approx(-0.5 * peak * 9.80665 * duration, rel=1e-9)
    other = rb.Sawtooth.profile(f"MIL-STD-810{name}", amplitude=f"-{peak} g", start="5 ms", direction="x")
    assert other.amplitude == -pulse.amplitude and other.start == 0.005


def test_an_unknown_shock_is_refused() -> None:
    """A name that is no pulse raises with the nearest one."""
    with pytest.raises(rb.CaseError, match=r"did you mean 'MIL-STD-810H 516\.8 ground'"):
        rb.Sawtooth.profile("MIL-STD-810H 516.8 grond")
