"""No contact is missed and none invented, first or later, alone or while others are closed: a fine grid against the log."""

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import rattlebox as rb
from rattlebox.results.schema import variables

Array = NDArray[np.float64]
CLOSE = 1e-8
"""Minimum gaps below this fraction of the clearance are not distinguished from touching: the accuracy of the grid."""
HARD = [308, 327, 342, 518, 1027]
"""Contacts that reopen within a step, or that close from rest while others are closed."""
IN_CONTACT = 16
"""Grid intervals in each contact; between contacts the grid has a step of 0.1 ms, about a thousandth of a period."""


def random_damper(rng: np.random.Generator, number: int) -> Any:
    """Return a cavity with one to four balls, at rest or moving."""
    count = int(rng.choice([1, 1, 2, 3, 4]))
    e = float(rng.uniform(0.3, 1.0))
    ending = str(rng.choice(["zero_force", "zero_overlap"]))
    law = [
        rb.Tsuji(restitution=e, ending=ending),
        rb.Tsuji(alpha=float(rng.uniform(0, 0.5)), ending=ending),
        rb.Linear(contact_time=float(10 ** rng.uniform(-4, -2.5)), restitution=e, ending=ending),
        rb.Thornton(yield_pressure=float(10 ** rng.uniform(8, 9.5))),
    ][int(rng.integers(4))]
    soft = rb.Material(density=7850.0, young=float(10 ** rng.uniform(7, 11.3)), poisson=0.3, yield_stress=1e9)
    return rb.ImpactDamper(
        name=f"damper {number}",
        balls=[rb.Sphere(radius=float(r), material=soft) for r in rng.uniform(3e-3, 1e-2, count)],
        gap=float(10 ** rng.uniform(-3.7, -2.7)),
        start=list(np.sort(np.clip(rng.uniform(-1.2, 1.2, count), -1, 1))),
        velocity=list(0.2 * rng.normal(size=count) * (rng.random(count) < 0.8)),
        gravity=float(rng.choice([0.0, 0.0, -9.81])),
        contact=law,
        point="tip",
    )


def random_case(seed: int) -> Any:
    """Return one to three dampers on one to three modes under a pulse or a steady load."""
    rng = np.random.default_rng(seed)
    modes = int(rng.integers(1, 4))
    load = (
        rb.Harmonic(amplitude=float(10 * rng.normal()), frequency=float(rng.uniform(2, 30)), point="tip")
        if rng.random() < 0.5
        else rb.HalfSine(amplitude=float(100 * rng.normal()), duration=float(rng.uniform(1e-3, 1e-2)), point="tip")
    )
    return rb.Case(
        structure=rb.Modal(
            frequencies=list(np.sort(rng.uniform(2, 40, modes))),
            damping_ratios=list(10 ** rng.uniform(-3, -1, modes)),
            shapes={"tip": list(rng.uniform(0.2, 1, modes) * rng.choice([-1, 1], modes))},
            velocity=list(0.2 * rng.normal(size=modes) * (rng.random() < 0.8)),
        ),
        dampers=[random_damper(rng, number + 1) for number in range(int(rng.integers(1, 4)))],
        load=load,
        duration=0.1,
        method=rb.EventDriven(max_events=20_000),
        output=rb.Output(times=[0.0]),
    )


def gaps(a: Any, damper: int) -> tuple[Array, Array]:
    """Return the gaps of a row and their rates, (contacts, T)."""
    own = np.flatnonzero(a.ball_damper == damper)
    half = np.full(a.time.size, 0.5 * a.clearance[damper])
    place = (a.relative_position - a.ball_centre)[:, own].T
    value = np.diff(np.vstack([-half, place, half]), axis=0)
    still = np.zeros(a.time.size)
    return value, np.diff(np.vstack([still, a.relative_velocity[:, own].T, still]), axis=0)


def lowest(time: Array, value: Array, rate: Array) -> Array:
    """Return the smallest value in each interval of the cubics through values and rates at both ends."""
    h, v0, v1 = np.diff(time), value[:-1], value[1:]
    r0, r1 = rate[:-1] * h, rate[1:] * h
    c2, c3 = 3 * (v1 - v0) - 2 * r0 - r1, 2 * (v0 - v1) + r0 + r1
    # Roots of r0 + 2 c2 s + 3 c3 s^2 without cancellation.
    root = np.sqrt(np.maximum(c2 * c2 - 3 * c3 * r0, 0))
    q = -(c2 + np.copysign(root, c2))
    with np.errstate(divide="ignore", invalid="ignore"):
        result = np.array([q / (3 * c3), r0 / q])
    s = np.where((result > 0) & (result < 1), result, 0)
    return np.minimum(np.minimum(v0, v1), (v0 + s * (r0 + s * (c2 + s * c3))).min(axis=0))


def on_a_grid(case: Any) -> Any:
    """Run a case with output on a grid that is fine in flights and finer in the contacts that were logged."""
    log = rb.simulate(case).arrays.impacts
    parts = np.linspace(0, 1, IN_CONTACT + 1)
    inside = log.time[:, None] + np.nan_to_num(log.duration)[:, None] * parts
    inside[:, -1] = np.nextafter(inside[:, -1], np.inf)
    times = np.concatenate([np.arange(0, case.duration, 1e-4), inside.ravel()])
    return rb.simulate(case.model_copy(update={"output": rb.Output(times=times)}))


def log_differences(a: Any, seen: Counter[str]) -> Iterator[str]:
    """Yield the differences between the gaps on the grid and the log, and count the comparisons."""
    log = a.impacts
    end = np.where(log.complete, log.time + np.nan_to_num(log.duration), np.inf)
    for damper in range(len(a.dampers)):
        blur = CLOSE * a.clearance[damper]
        for contact, (value, rate) in enumerate(zip(*gaps(a, damper), strict=True)):
            free = np.ones(a.time.size - 1, bool)
            for i in np.flatnonzero((log.damper == damper) & (log.contact == contact)):
                first, stop = (int(k) for k in np.searchsorted(a.time, [log.time[i], min(end[i], a.time[-1])]))
                speed = log.approach_speed[i]
                if a.time[first] != log.time[i]:
                    yield f"{damper}/{contact}: no touch at {log.time[i]}"
                # Contacts from rest are logged an instant later, after a negligible motion.
                deep, fast = (max(blur, 1e-5 * log.peak_overlap[i]), 1e-4) if speed == 0 else (blur, 1e-7)
                if not abs(value[first]) <= deep or not abs(rate[first] + speed) <= fast:
                    yield f"{damper}/{contact}: logged at {log.time[i]}, gap {value[first]}, rate {rate[first]}"
                inside = value[first + 1 : stop]
                if inside.size and inside.max() > blur:
                    yield f"{damper}/{contact}: open within the contact of {log.time[i]}"
                seen["contacts"] += 1
                seen["while another is closed"] += bool(
                    np.count_nonzero((log.time <= log.time[i]) & (end > log.time[i])) > 1
                )
                seen["from rest"] += bool(speed == 0)
                # After a release the bodies recover, and the surfaces separate slightly later.
                parted = np.flatnonzero(value[stop:] >= 0)
                free[first - (first > 0 and speed == 0) : stop + (int(parted[0]) if parted.size else a.time.size)] = (
                    False
                )
            deepest = lowest(a.time, value, rate)
            for k in np.flatnonzero(free & (deepest < -blur)):
                yield f"{damper}/{contact}: {-deepest[k]} m deep at {a.time[k]}, but nothing is logged"
            seen["near misses"] += int(
                np.count_nonzero(free & (deepest > blur) & (deepest < 1e-3 * a.clearance[damper]))
            )


def check(seeds: Iterable[int]) -> Counter[str]:
    """Check these cases, and return the counts of comparisons."""
    seen: Counter[str] = Counter()
    for seed in seeds:
        run = on_a_grid(random_case(seed))
        wrong = list(log_differences(run.arrays, seen))
        assert not wrong, f"case {seed}: " + "; ".join(wrong[:3])
        assert run.ok and run.energy_residual <= 1e-9, (
            f"case {seed}: {run.status}, energy residual {run.energy_residual}"
        )
    return seen


def test_every_contact_of_sixty_cases_is_logged() -> None:
    """In rows of balls in several cavities the contacts on a fine grid are those of the log."""
    seen = check([*range(60), *HARD])
    assert seen["contacts"] > 3000
    assert seen["while another is closed"] > 1500
    assert seen["near misses"] > 300


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_every_contact_of_ten_thousand_cases_is_logged(block: int) -> None:
    """The contacts of ten thousand random cases are those on a fine grid."""
    assert check(range(500 * block, 500 * (block + 1)))["from rest"] > 0


@pytest.mark.parametrize("fault", ["missed", "invented", "shifted"])
def test_grid_finds_a_wrong_log(fault: str) -> None:
    """The comparison detects a missing impact, an additional one, and an error of one microsecond."""
    a = on_a_grid(random_case(3)).arrays
    assert not list(log_differences(a, Counter()))
    log = a.impacts
    lines = {v.name: np.array(getattr(log, v.name)) for v in variables("impact", "impacts")}
    k = len(log) // 2
    if fault == "missed":
        lines = {name: np.delete(values, k) for name, values in lines.items()}
    elif fault == "invented":
        lines = {name: np.append(values, values[k]) for name, values in lines.items()}
        lines["time"][-1] = 0.5 * (a.time[5] + a.time[6])
    else:
        lines["time"][k] -= 1e-6
    assert list(log_differences(a.replaced(impacts=lines), Counter()))
