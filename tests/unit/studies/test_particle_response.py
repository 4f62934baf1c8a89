"""Frequency responses with particles: exact limits, the 1-D engine, intervals, sequence, backends, stores."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import rattlebox as rb
from rattlebox.studies.run.runner import Stopped
from rattlebox.studies.work.reductions import steady_motion

STRUCTURE = rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping="20 N s/m")
QUICK: dict[str, Any] = {"cycles": (5, 6), "samples": 16, "progress": False}


def bits(data: xarray.Dataset) -> dict[str, bytes]:
    """Return every variable to the last bit."""
    return {str(name): values.values.tobytes() for name, values in data.data_vars.items()}


def box(**changes: Any) -> rb.Case:
    """Return a box of balls on an oscillator."""
    parts: dict[str, Any] = {
        "structure": STRUCTURE,
        "damper": rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="6 mm", count=12),
            cavity=rb.Box(size=("20 mm", "20 mm", "24 mm")),
            contact=rb.Tsuji(restitution=0.7),
            friction=0.3,
            direction="z",
            packing=rb.Settled(seed=1),
            softening=1000,
        ),
        "load": rb.Harmonic(amplitude="10 N", frequency="30 Hz"),
        "duration": "1 s",
    }
    return rb.Case(**(parts | changes))


def one_ball(**changes: Any) -> rb.ParticleDamper:
    """Return one ball between a floor and a lid."""
    parts: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="28 mm", count=1),
        "cavity": rb.Box(size=("40 mm", "40 mm", "30 mm")),
        "contact": rb.Tsuji(restitution=0.6),
        "direction": "z",
        "gravity": [0, 0, 0],
        "packing": rb.Positions(positions=[[0, 0, 0]]),
        "softening": 10,
    }
    return rb.ParticleDamper(**(parts | changes))


def exact(mass: float, hertz: Any, level: float, damping: float = 20.0) -> Any:
    """Return the displacement of a mass on the spring and the dashpot of the structure."""
    omega = 2 * np.pi * np.asarray(hertz)
    return level / (40e3 - mass * omega**2 + 1j * damping * omega)


@pytest.mark.parametrize(("amplitude", "gravity"), [("0.2 N", -9.81), ("10 N", -500.0)])
def test_balls_that_rest_are_an_added_mass(amplitude: str, gravity: float) -> None:
    """A ball that gravity holds on the floor gives the exact response of both masses, in amplitude and phase."""
    damper = one_ball(gravity=[0, 0, gravity], packing=rb.Positions(positions=[[0, 0, "-0.99 mm"]]))
    case = rb.Case(
        structure=STRUCTURE,
        damper=damper,
        load=rb.Harmonic(amplitude=amplitude, frequency="30 Hz", phase=0.4),
        duration="1 s",
    )
    hertz = [25.0, 29.0, 31.0, 40.0]
    found = rb.frequency_response(case, hertz, direction="up", cycles=(40, 12), progress=False)
    mass = float(case.particle_dampers[0].contents.mass.sum())
    wanted = exact(1 + mass, hertz, found.level.item())
    assert (found.status == 0).all()
    assert found.amplitude.values[0, 0] == pytest.approx(np.abs(wanted), rel=2e-3)
    assert found.phase.values[0, 0] == pytest.approx(np.angle(wanted), abs=3e-3)


def test_a_ball_of_no_mass_does_nothing() -> None:
    """Without mass in the cavity the response is that of the structure, which `bare_amplitude` holds exactly."""
    dust = rb.Material(name="dust", density=1.0, young="0.1 MPa", poisson=0.3)
    case = rb.Case(
        structure=STRUCTURE,
        damper=one_ball(particles=rb.Particles(material=dust, diameter="28 mm", count=1)),
        base=rb.Harmonic(amplitude="2 m/s^2", frequency="30 Hz"),
        duration="1 s",
    )
    hertz = [28.0, 31.5, 35.0]
    found = rb.frequency_response(case, hertz, direction="down", cycles=(40, 12), progress=False)
    wanted = exact(1.0, hertz, -2.0)
    assert found.amplitude.values[0, 0] == pytest.approx(np.abs(wanted), rel=1e-3)
    assert found.phase.values[0, 0] == pytest.approx(np.angle(wanted), abs=1e-3)
    assert found.bare_amplitude.values[0] == pytest.approx(np.abs(wanted), rel=1e-12)
    assert found.level.attrs["units"] == "m/s^2"


def test_one_ball_agrees_with_the_1d_engine() -> None:
    """Up and down, in the regular and the chaotic range, both engines agree within intervals and the error of the step.

    At 28 Hz either engine ends in a motion of period 2 after a chaotic transient of some 100 to 1000 cycles, whose length
    differs; 29 Hz has none.
    """
    options: dict[str, Any] = {"cycles": (100, 320), "progress": False, "measure": "loss_per_cycle"}
    parts: dict[str, Any] = {"load": rb.Harmonic(amplitude="10 N", frequency="30 Hz"), "duration": "1 s"}
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    )
    hertz = [29.0, 30.0, 32.0, 35.0]
    line = rb.frequency_response(rb.Case(structure=STRUCTURE, damper=ball, **parts), hertz, **options)
    space = rb.frequency_response(rb.Case(structure=STRUCTURE, damper=one_ball(softening=1), **parts), hertz, **options)
    assert (line.period.values == space.period.values).all()
    for name, step in (("amplitude", 2e-3), ("rms", 2e-3), ("phase", 2e-3), ("loss_per_cycle", 0.01)):
        scatter = line[f"{name}_interval"] + space[f"{name}_interval"]
        known = np.isfinite(scatter)
        assert known.mean() >= 0.5, name
        assert (abs(space[name] - line[name]) <= 1.5 * scatter + step * abs(line[name])).values[known].all(), name


def test_intervals_over_cycles() -> None:
    """With four times the cycles the interval is about half as wide, and the two intervals overlap."""
    case = box()
    few, many = (
        rb.frequency_response(case, [27.0, 29.0], direction="up", cycles=(40, n), samples=16, progress=False)
        for n in (120, 480)
    )
    for name in ("amplitude", "rms"):
        half = [found[f"{name}_interval"].values for found in (few, many)]
        known = np.isfinite(half[0] + half[1])
        assert known.any()
        assert (np.abs(few[name] - many[name]).values < 1.5 * (half[0] + half[1]))[known].all()
        assert 0.2 < np.mean((half[1] / half[0])[known]) < 1
    assert (many.phase_interval < 1e-3).all()


def test_each_frequency_starts_from_the_one_before() -> None:
    """In a sweep down the first frequency alone starts from the case; with "fresh" each one does."""
    case = box()
    down = rb.frequency_response(case, [29.0, 31.0], direction="down", **QUICK)
    fresh = rb.frequency_response(case, [29.0, 31.0], direction="fresh", **QUICK)
    assert down.amplitude.dims == fresh.amplitude.dims == ("direction", "level", "frequency")
    assert bits(down.isel(frequency=1).drop_vars("direction")) == bits(fresh.isel(frequency=1).drop_vars("direction"))
    assert down.amplitude[0, 0, 0] != fresh.amplitude[0, 0, 0]


def test_bits_do_not_depend_on_workers() -> None:
    """Threads and processes return the same bits."""
    case, hertz = box(), [29.0, 30.0]
    one, two = (rb.frequency_response(case, hertz, levels=["5 N", "10 N"], workers=n, **QUICK) for n in (1, 2))
    assert one.drop_attrs().equals(two.drop_attrs())
    processes = rb.frequency_response(case, hertz, levels=["5 N", "10 N"], backend="processes", workers=2, **QUICK)
    assert one.drop_attrs().equals(processes.drop_attrs())


def test_a_stopped_sweep_resumes_within_it(tmp_path: Path) -> None:
    """A stopped study continues with the next frequency, from the stored state, with the bits of one that ran through."""
    case, hertz = box(), [28.0, 29.0, 30.0, 31.0]
    options: dict[str, Any] = {**QUICK, "direction": "down", "store": tmp_path / "response.zarr", "workers": 1}
    with pytest.raises(Stopped):
        rb.frequency_response(case, hertz, **{**options, "progress": lambda done, _: done < 2})
    states = tmp_path / "response.zarr" / "progress"
    assert sorted(file.name for file in states.glob("state-*.npz")) == ["state-2.npz", "state-3.npz"]
    steps: list[int] = []
    resumed = rb.frequency_response(case, hertz, **{**options, "progress": lambda done, _: steps.append(done)})
    assert steps[0] == 2
    assert not list(states.glob("state-*.npz"))
    through = rb.frequency_response(case, hertz, **{**options, "store": None})
    assert bits(resumed) == bits(through)
    assert bits(rb.open_study(tmp_path / "response.zarr")) == bits(through)


def test_a_damaged_state_costs_time_only(tmp_path: Path) -> None:
    """If the last state is damaged, the sweep continues from the one before; without any, from its start."""
    case, hertz = box(), [28.0, 29.0, 30.0, 31.0]
    through = rb.frequency_response(case, hertz, direction="up", **QUICK)
    for damaged in (1, 2):
        store = tmp_path / f"{damaged}.zarr"
        options: dict[str, Any] = {**QUICK, "direction": "up", "store": store, "workers": 1}
        with pytest.raises(Stopped):
            rb.frequency_response(case, hertz, **{**options, "progress": lambda done, _: done < 3})
        for number in range(damaged):
            file = store / "progress" / f"state-{2 - number}.npz"
            file.write_bytes(file.read_bytes()[:-100])
        assert bits(rb.frequency_response(case, hertz, **options)) == bits(through)


def test_softening_auto_is_the_same_at_all_frequencies() -> None:
    """One value, the smallest, holds for all frequencies of a sweep, so that contacts keep their stiffness."""
    damper = one_ball(gravity=[0, 0, -9.81], softening="auto", packing=rb.Settled(seed=1))
    case = rb.Case(
        structure=STRUCTURE, damper=damper, load=rb.Harmonic(amplitude="50 N", frequency="30 Hz"), duration="1 s"
    )
    study = rb.studies.kinds.frequency_response.FrequencyResponse(case, [28.0, 60.0], direction="up", **QUICK)
    factor = study.work.engine.case.particle_dampers[0].softening_factor
    alone = [rb.studies.kinds.frequency_response.resolve_softening(study.grid.case_at(case, k))[0] for k in range(2)]
    values = [each.particle_dampers[0].softening_factor for each in alone]
    assert factor == min(values) < max(values)
    assert 'softening = "auto"' in study.run().attrs["case"]


def test_a_frequency_that_cannot_run_is_refused() -> None:
    """A step that is too long has a status and a reason instead of an error."""
    found = rb.frequency_response(box(method=rb.Dem(dt="1 ms")), [29.0], direction="up", **QUICK)
    assert found.status.values.item() == found.status.attrs["flag_meanings"].split().index("refused")
    assert found.attrs["refused"]
    assert np.isnan(found.amplitude).all()
    assert (found.period == 0).all()


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        (
            {"load": [rb.Harmonic(amplitude=1.0, frequency=9.0), rb.HalfSine(amplitude=1.0, duration=0.1)]},
            {},
            "does not continue",
        ),
        ({"load": rb.Harmonic(amplitude=1.0, frequency=9.0, start=1.0)}, {}, "before the harmonic"),
        ({"structure": rb.Fixed(), "load": []}, {}, "has no modes"),
        ({}, {"measure": "impacts"}, "single impacts"),
        ({}, {"point": "tip"}, "tip"),
        ({}, {"frequencies": [31.0, 30.0]}, "strictly rising"),
    ],
)
def test_bad_input_is_refused(changes: dict[str, Any], options: dict[str, Any], message: str) -> None:
    """Bad arguments are refused with advice, before anything runs."""
    with pytest.raises(rb.CaseError, match=message):
        rb.frequency_response(box(**changes), **{"frequencies": [30.0, 31.0], **QUICK, **options})


def test_intervals_scale_with_the_motion() -> None:
    """A motion of twice the size has intervals of amplitude of twice the size, and the same intervals of phase."""
    samples, cycles = 16, 60
    noise = np.random.default_rng(4).standard_normal(samples * cycles + 1)
    motion = 1e-3 * (np.sin(2 * np.pi * np.arange(noise.size) / samples) + 0.1 * noise)
    one, two = (steady_motion(size * motion, np.zeros((noise.size, 0)), 0.0, samples, 1e-3) for size in (1.0, 2.0))
    assert one["amplitude"] == pytest.approx(1e-3, rel=0.05)
    assert 0 < one["amplitude_interval"] < 0.05 * one["amplitude"]
    assert two["amplitude_interval"] == pytest.approx(2 * one["amplitude_interval"], rel=1e-12)
    assert two["phase_interval"] == pytest.approx(one["phase_interval"], rel=1e-12)
