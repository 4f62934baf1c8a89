"""Lyapunov exponents: over axes, for any phase of the load, of sticking motions, against diverging pairs of runs."""

import math
import runpy
import time
from pathlib import Path

import numpy as np
import pytest

import rattlebox as rb
from rattlebox import analysis
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.kinds.lyapunov import PairEngine

EXAMPLE = Path(__file__).parents[3] / "examples" / "lyapunov.py"
QUICK = {"cycles": (60, 60), "pairs": 3, "progress": False}


def case(**changes):
    """Return a small ball with hard impacts in a light, weakly damped structure."""
    parts = {
        "structure": rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        "damper": rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        "load": rb.Harmonic(amplitude="5 N", frequency="31 Hz"),
        "duration": "1 s",
        "method": rb.Newton(),
    }
    return rb.Case(**{**parts, **changes})


def inelastic(restitution):
    """Return a ball on a shaker that it leaves once per cycle."""
    return rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1.5 mm", frequency="15 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="10 mm", material="steel"),
            gap="20 mm",
            start=-1.0,
            gravity=-9.81,
            contact=rb.Tsuji(restitution=0.5),
        ),
        duration="1 s",
        method=rb.Newton(restitution=restitution),
    )


def test_example():
    """In the example the motion is chaotic at first; the growth of the last periodic motion has the exact multiplier."""
    result = runpy.run_path(str(EXAMPLE))["study"].growth_per_cycle
    half_cycle = 0.9349517810953712  # exact multiplier at 33 Hz by the solution of Masri and Caughey (1966)
    assert float(result[-1]) == pytest.approx(2 * math.log(half_cycle), rel=1e-4)
    assert (result[:2] > 0.5).all()


def test_variants_are_independent():
    """A variant has the same bits alone, among others and with any number of threads."""
    axes = {"load.frequency": [29.0, 31.0, 33.0], "damper.gap": ["0.8 mm", "1 mm"]}
    one, two = (rb.lyapunov(case(), axes, workers=n, **QUICK) for n in (1, 2))
    assert one.drop_attrs().equals(two.drop_attrs())
    variant = read_axes(case(), axes).case_at(case(), 3)
    alone = rb.lyapunov(variant, **QUICK)
    assert float(alone.exponent) == float(one.exponent[1, 1])
    assert (alone.running_exponent.values == one.running_exponent.values[1, 1]).all()


def test_study_on_disk(tmp_path):
    """With a store the result is the same, and a second call reads it."""
    axes = {"load.frequency": [29.0, 33.0]}
    stored = rb.lyapunov(case(), axes, store=tmp_path / "map.zarr", **QUICK).load()
    again = rb.lyapunov(case(), axes, store=tmp_path / "map.zarr", **QUICK).load()
    here = rb.lyapunov(case(), axes, **QUICK)
    for result in (stored, again):
        assert (result.exponent.values == here.exponent.values).all()
        assert (result.running_exponent.values == here.running_exponent.values).all()
    alone = rb.lyapunov(case(), store=tmp_path / "alone.zarr", **QUICK).load()
    assert alone.equals(rb.lyapunov(case(), **QUICK))
    assert alone.exponent.dims == ()
    with pytest.raises(rb.StoreError, match="pairs"):
        rb.lyapunov(case(), axes, store=tmp_path / "map.zarr", **{**QUICK, "pairs": 4})


def test_units_and_names():
    """Each variable has unit and long name; exponent, growth per cycle and running exponent are consistent."""
    result = rb.lyapunov(case(), {"load.frequency": [30.0, 33.0]}, **QUICK)
    assert all({"units", "long_name"} <= set(v.attrs) for n, v in result.items() if n != "status")
    assert result.growth_per_cycle.values == pytest.approx(result.exponent.values / [30.0, 33.0])
    assert (result.running_exponent[:, -1] == result.exponent).all()
    assert result.cycle.values == pytest.approx(np.arange(1, 61))


def test_the_phase_of_the_strobe_does_not_matter():
    """The exponent is the same if soft contacts are closed at the end of each cycle."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"),
        gap="1 mm",
        contact=rb.Linear(contact_time="1 ms", restitution=0.6),
    )
    turned = {"load.phase": np.linspace(0, math.pi, 9)[:-1]}  # a contact lasts a sixteenth of half a cycle
    soft = case(damper=damper, method=rb.EventDriven(), load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"))
    result = rb.lyapunov(soft, turned, cycles=(200, 200), pairs=2, progress=False)
    impacts = rb.sweep(soft, turned, ["impacts_per_cycle"], cycles=(200, 200), progress=False)
    assert impacts.impacts_per_cycle.values == pytest.approx(2.0)
    assert float(result.growth_per_cycle[0]) < -0.05
    assert np.ptp(result.growth_per_cycle.values) < 1e-4


def test_sticking_motions_have_an_infinite_negative_exponent():
    """A ball that comes to rest on a shaker leaves it at the same time for any perturbation: the exponent is -inf."""
    result = rb.lyapunov(inelastic(0.0), **QUICK)
    assert float(result.exponent) == -math.inf
    assert np.isneginf(result.running_exponent).all()
    assert np.isnan(result.standard_error)
    assert float(rb.lyapunov(inelastic(0.85), **QUICK).exponent) > 1


def test_chaos_agrees_with_diverging_pairs():
    """Pairs without renormalisation from many points of the attractor diverge with the same exponent."""
    brought_back = rb.lyapunov(case(), cycles=(150, 600), pairs=8, progress=False)
    shared = {"ball": rb.Sphere(radius="14 mm", material="steel"), "gap": "1 mm", "contact": rb.Tsuji(restitution=0.6)}
    taken = rb.Output(times=np.arange(150, 150 + 3 * 96, 3) / 31)
    a = rb.simulate(case(duration=440 / 31, output=taken)).arrays
    states = [s[-96:, 0] for s in (a.displacement, a.velocity, a.relative_position, a.ball_velocity)]

    def motions(shift):
        cases = [
            case(
                structure=rb.SDOF(mass=1.0, stiffness=40e3, damping_ratio=0.01, displacement=z, velocity=v),
                damper=rb.ImpactDamper(start=(y + shift) / 1e-3, velocity=w, **shared),
                duration=20 / 31,
                output=rb.Output(times=np.arange(21) / 31),
            )
            for z, v, y, w in zip(*states, strict=True)
        ]
        result = [run.arrays for run in rb.simulate_many(cases)]
        parts = [(b.displacement, b.velocity / 200, b.ball_position, b.ball_velocity / 200) for b in result]
        return np.array([np.hstack(part) for part in parts])

    apart = np.linalg.norm(motions(1e-12) - motions(0.0), axis=2)
    alone = analysis.lyapunov_exponent(np.arange(3, 21) / 31, apart[:, 3:], saturation=1e-5)
    error = math.hypot(float(brought_back.standard_error), float(alone.standard_error))
    assert float(brought_back.exponent) > 30
    assert error < 2
    assert float(alone.exponent) == pytest.approx(float(brought_back.exponent), abs=3 * error)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pairs": 0}, "pairs = 0"),
        ({"steps": 1}, "steps = 1"),
        ({"distance": 1.0}, "distance = 1.0\n  must be at most 0.0001"),
        ({"reach": -1.0}, "reach"),
        ({"cycles": (10, 0)}, "to evaluate, >= 1"),
        ({"axes": {"load.frequenzy": [30.0]}}, "frequency"),
        ({"axes": {"duration": [1.0, 2.0]}, "cycles": None}, "duration"),
    ],
)
def test_bad_input_is_refused(options, message):
    """Bad arguments are refused with advice before the first run."""
    with pytest.raises(rb.CaseError, match=message):
        rb.lyapunov(case(), **{**QUICK, **options})


def test_loads_without_period_are_refused():
    """Cases with a record or with cycles of a pulse are refused with an alternative."""
    record = rb.Record(times=[0.0, 1.0], values=[1.0, 0.0])
    with pytest.raises(rb.CaseError, match="pairs of runs"):
        rb.lyapunov(case(load=record))
    with pytest.raises(rb.CaseError, match="harmonic"):
        rb.lyapunov(case(load=rb.HalfSine(amplitude=1.0, duration=0.01)), **QUICK)


def test_cancellation():
    """A cancelled task ends soon, also during the transient cycles."""
    task = PairEngine(case(), read_axes(case(), {"load.frequency": np.linspace(29, 33, 64)}), cycles=(20000, 20000))
    begun = time.perf_counter()
    assert task.run(range(64), threads=1, cancelled=lambda: time.perf_counter() - begun > 0.3) is None
    assert time.perf_counter() - begun < 1.5
