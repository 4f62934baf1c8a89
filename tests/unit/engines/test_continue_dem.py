"""A particle run continues from the end of another one: particles, contacts, structure, load."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.engines.dem import continue_dem, simulate_dem
from rattlebox.engines.end_state import EndState

STEP = 1 / 30 / 64 / 200


def case(cycles: int, frequency: float = 30.0, **changes: Any) -> rb.Case:
    """Return a box of balls on an oscillator, in equal time steps."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="30 Hz", damping_ratio=0.01),
        "damper": rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="5 mm", count=20),
            cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
            contact=rb.Tsuji(restitution=0.7),
            friction=0.3,
            rolling=0.01,
            direction="z",
            packing=rb.Settled(seed=1),
            softening=100,
        ),
        "load": rb.Harmonic(amplitude="5 N", frequency=frequency, phase=0.3),
        "duration": cycles / frequency,
        "output": rb.Output(rate=64 * frequency),
        "method": rb.Dem(dt=STEP),
    }
    return rb.Case(**(parts | changes))


def test_two_runs_are_one() -> None:
    """Two runs of three cycles are one of six: motion, energies and losses, until rounding has grown."""
    whole = simulate_dem(case(6), threads=1)
    first, end = continue_dem(case(3), None, threads=1)
    assert first.arrays.displacement.tobytes() == whole.arrays.displacement[: first.arrays.time.size].tobytes()
    again = EndState.from_arrays(end.arrays())
    second, _ = continue_dem(case(3), again, threads=1)
    assert second.status == "finished"
    middle, near = first.arrays.time.size - 1, slice(0, 40)
    assert second.arrays.time[near] == pytest.approx(whole.arrays.time[middle:][near] - whole.arrays.time[middle])
    for name in ("displacement", "velocity", "kinetic_energy", "rotation_energy", "contact_energy", "momentum"):
        ours, theirs = getattr(second.arrays, name)[near], getattr(whole.arrays, name)[middle:][near]
        assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-12 * np.abs(theirs).max()), name
    for name in ("normal_loss", "sliding_loss", "rolling_loss", "load_work", "viscous_loss"):
        theirs = getattr(whole.arrays, name)[middle:][near]
        ours = getattr(second.arrays, name)[near]
        assert ours == pytest.approx(theirs - theirs[0], rel=1e-9, abs=1e-12 * np.abs(theirs).max()), name


def test_another_frequency_continues_without_a_jump() -> None:
    """The next frequency begins with the motion and the force of the last sample, and its energy balance closes."""
    first, end = continue_dem(case(3), None, threads=1)
    next_case = case(3, 31.7, method=rb.Dem())
    second, _ = continue_dem(next_case, end, threads=1)
    assert second.energy_residual < 1e-3
    for name in ("displacement", "velocity", "load", "kinetic_energy", "contact_energy", "centre_of_mass"):
        assert getattr(second.arrays, name)[0] == pytest.approx(getattr(first.arrays, name)[-1], rel=1e-12)
    assert second.counts["steps"] < 1.1 * simulate_dem(next_case, threads=1).counts["steps"]


def test_diagnostics_count_from_the_begin() -> None:
    """Extremes of a continued run exclude the run before: the speed of impacts falls when the load ends."""
    first, end = continue_dem(case(3), None, threads=1)
    still: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="30 Hz", damping_ratio=1.0),
        "load": rb.Harmonic(amplitude="1e-9 N", frequency=30.0),
    }
    for _ in range(3):
        run, end = continue_dem(case(4, **still), end, threads=1)
    assert run.diagnostics["largest_approach_speed"] < 0.5 * first.diagnostics["largest_approach_speed"]
    assert run.counts["steps"] == round(4 / 30 / STEP) + 1


def test_a_state_of_other_particles_is_refused() -> None:
    """A run continues without its load, or with two; a state of other particles is refused."""
    _, end = continue_dem(case(1), None, threads=1)
    for loads in ((), (rb.Harmonic(amplitude="5 N", frequency="30 Hz"), rb.HalfSine(amplitude="1 N", duration="1 ms"))):
        run, _ = continue_dem(case(1, load=loads), end, threads=1)
        assert run.ok
        assert run.arrays.load.shape[1] == len(loads)
        assert run.arrays.load_work.any() == bool(loads)
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="5 mm", count=19),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.7),
        friction=0.3,
        rolling=0.01,
        direction="z",
        softening=100,
    )
    with pytest.raises(ValueError, match="state"):
        continue_dem(case(1, damper=damper), end, threads=1)
