"""A run continues another one: the same bits as in one go, changed parameters, and what is refused.

No earlier test could see a fault of a state at the end of a run: nothing read it.
"""

from __future__ import annotations

import pickle
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

BALL = rb.Sphere(diameter="14 mm", material="steel")
SOFT: dict[str, Any] = {
    "tsuji": rb.Tsuji(restitution=0.7),
    "linear": rb.Linear(stiffness="60 kN/m", restitution=0.6),
    "thornton": rb.Thornton(yield_pressure="1 GPa"),
}
LOADS: dict[str, rb.Harmonic | rb.HalfSine | rb.Record] = {
    "harmonic": rb.Harmonic(amplitude="9 N", frequency="16.3 Hz"),
    "pulse": rb.HalfSine(amplitude="400 N", duration="0.3 s", start="0.15 s"),
    "record": rb.Record(times=[0, 0.11, 0.23, 0.37, 0.52, 0.8], values=[0, 30, -25, 40, -10, 0], unit="N"),
}
CUT = 0.31


def oscillator(**changes: Any) -> rb.SDOF:
    """Return a lightly damped oscillator, displaced at the start."""
    parts: dict[str, Any] = {"mass": "3 kg", "frequency": "17 Hz", "damping_ratio": 0.004, "displacement": "6 mm"}
    return rb.SDOF(**(parts | changes))


def damper(contact: Any = SOFT["tsuji"], count: int = 1, **options: Any) -> rb.ImpactDamper:
    """Return a row of balls with a clearance."""
    balls = {"ball": BALL} if count == 1 else {"balls": [BALL] * count}
    return rb.ImpactDamper(**balls, contact=contact, **{"gap": "1.1 mm", **options})


def case(**changes: Any) -> rb.Case:
    """Return an impact damper on an oscillator, with samples that do not depend on the contacts."""
    parts: dict[str, Any] = {
        "structure": oscillator(),
        "damper": damper(),
        "duration": "0.8 s",
        "output": rb.Output(rate="2 kHz"),
    }
    return rb.Case(**(parts | changes))


def assert_same_bits(whole: rb.Run, later: rb.Run) -> None:
    """Compare a continued run with the one in one go: motion, forces and the impact log."""
    first = np.searchsorted(whole.arrays.time, later.arrays.time[0])
    assert later.arrays.time[1:].tobytes() == whole.arrays.time[whole.arrays.time > later.arrays.time[0]].tobytes()
    shift = later.arrays.time.size - whole.arrays.time[first:].size
    assert shift in (0, 1), "the first sample may lie between two samples of the whole run"
    for name in ("displacement", "velocity", "ball_position", "ball_velocity", "cavity_force", "interface_force"):
        assert getattr(later.arrays, name)[shift:].tobytes() == getattr(whole.arrays, name)[first:].tobytes(), name
    log, cut = whole.arrays.impacts, later.arrays.time[0]
    goes_on = ~(log.time + log.duration <= cut) | (log.time >= cut)
    order = np.lexsort((later.arrays.impacts.contact, later.arrays.impacts.time))
    other = np.lexsort((log.contact[goes_on], log.time[goes_on]))
    for name in ("time", "approach_speed", "peak_force", "energy_lost", "duration", "complete"):
        ours, theirs = getattr(later.arrays.impacts, name)[order], getattr(log, name)[goes_on][other]
        assert np.array_equal(ours, theirs, equal_nan=name != "complete"), name
    assert later.ok
    assert later.energy_residual < 1e-8


def continued(whole: rb.Case, cut: float, **changes: Any) -> rb.Run:
    """Run a case up to a time, then to its end, with changes from there on."""
    first = rb.simulate(whole.replaced({"duration": cut}))
    assert first.ok
    return rb.simulate(whole.replaced(changes) if changes else whole, start=first)


@pytest.mark.parametrize("law", SOFT)
@pytest.mark.parametrize("count", [1, 3])
def test_soft_balls_in_flight_and_in_contact(law: str, count: int) -> None:
    """Cut in flight, at a touch, within a contact and where one ends, the later part has the bits of the whole run."""
    whole_case = case(damper=damper(SOFT[law], count))
    whole = rb.simulate(whole_case)
    number = len(whole.impacts.time) // 2
    touch, duration = whole.impacts.time.values[number], whole.impacts.duration.values[number]
    for cut in (CUT, touch, *(touch + share * duration for share in (0.02, 0.3, 0.5, 0.8, 0.999, 1.0))):
        assert_same_bits(whole, continued(whole_case, float(cut)))


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("method", ["event_driven", "newton"])
def test_loads_across_the_seam(load: str, method: str) -> None:
    """A harmonic, a pulse and a record act on at their times, also where the cut is just before or at a knot."""
    kind = {"event_driven": rb.EventDriven(), "newton": rb.Newton()}[method]
    whole_case = case(load=LOADS[load], method=kind, structure=oscillator(displacement=0.0))
    whole = rb.simulate(whole_case)
    for cut in (CUT, 0.15, 0.37, 0.4499, 0.52 - 1e-9):
        assert_same_bits(whole, continued(whole_case, cut))


@pytest.mark.parametrize("restitution", [0.0, 0.4, 0.9])
def test_hard_balls_and_balls_at_rest(restitution: float) -> None:
    """Hard rows under gravity, of which some balls stick at the cut, continue with the same bits."""
    row = damper(rb.Tsuji(restitution=0.5), 3, gravity="-9.81 m/s^2")
    load = rb.Harmonic(amplitude="25 N", frequency="9 Hz")
    whole_case = case(damper=row, load=load, method=rb.Newton(restitution=restitution))
    whole = rb.simulate(whole_case)
    assert whole.counts["sticks"] > 0 or restitution == 0.9
    rng = np.random.default_rng(3)
    for cut in (CUT, *rng.uniform(0.05, 0.75, 8)):
        assert_same_bits(whole, continued(whole_case, float(cut)))


def test_a_ball_that_lies_on_the_floor() -> None:
    """A soft contact that lasts for the whole run is repeated from its begin, with the same bits after the cut."""
    lying = damper(SOFT["tsuji"], gravity="-9.81 m/s^2", start="-1.1 mm")
    load = rb.Harmonic(amplitude="2 N", frequency="6 Hz")
    whole_case = case(damper=lying, load=load, structure=oscillator(displacement=0.0))
    whole = rb.simulate(whole_case)
    for cut in (0.2, CUT, 0.55):
        assert_same_bits(whole, continued(whole_case, cut))


def test_random_cuts() -> None:
    """Random cuts of two dampers and a tuned mass, under a load: each continues with the same bits."""
    law: dict[str, Any] = {"contact": rb.Tsuji(restitution=0.6)}
    structure = rb.ShearBuilding(masses=["400 kg"] * 3, stiffnesses=["300 kN/m"] * 3, damping_ratio=0.01)
    parts: dict[str, Any] = {
        "structure": structure,
        "tuned_mass": rb.TunedMass(mass="8 kg", frequency="1.9 Hz", damping_ratio=0.05, point="storey 3"),
        "dampers": [
            rb.ImpactDamper(ball=rb.Sphere(diameter="80 mm", material="steel"), gap="9 mm", point="tuned mass", **law),
            rb.ImpactDamper(ball=rb.Sphere(diameter="90 mm", material="steel"), gap="4 mm", point="storey 2", **law),
        ],
        "base": rb.Harmonic(amplitude="0.6 m/s^2", frequency="1.95 Hz"),
        "duration": "6 s",
        "output": rb.Output(rate="200 Hz"),
    }
    for method in (rb.EventDriven(), rb.Newton(restitution=0.6)):
        whole_case = rb.Case(**parts, method=method)
        whole = rb.simulate(whole_case)
        assert len(whole.impacts.time) > 20
        for cut in np.random.default_rng(5).uniform(1.0, 5.5, 12):
            assert_same_bits(whole, continued(whole_case, float(cut)))


@pytest.mark.parametrize("method", ["event_driven", "newton"])
def test_stops(method: str) -> None:
    """Stops with and without a gap continue with the same bits, also in a contact; their impulses count from the seam."""
    kind = {"event_driven": rb.EventDriven(), "newton": rb.Newton(restitution=0.7)}[method]
    stops = [
        rb.Stop(gap="1 mm", contact=rb.Linear(stiffness="400 kN/m", restitution=0.7), side="both"),
        rb.Stop(gap="0 mm", contact=rb.Linear(stiffness="90 kN/m", restitution=0.5)),
    ]
    whole_case = case(stops=stops, structure=oscillator(displacement="-0.9 mm"), load=LOADS["harmonic"], method=kind)
    whole = rb.simulate(whole_case)
    times, durations = whole.impacts.time.values, whole.impacts.duration.values
    cuts = [CUT, *(float(times[k] + 0.4 * np.nan_to_num(durations[k])) for k in range(3, len(times) - 1, 9)), 0.7]
    for cut in cuts:
        later = continued(whole_case, cut)
        assert_same_bits(whole, later)
        assert not later.arrays.stop_impulse[0].any()
    first = rb.simulate(whole_case.replaced({"duration": CUT}))
    assert "and 2 stops" in refusal(
        first, case(stops=stops[:1], structure=oscillator(displacement="-0.9 mm"), method=kind)
    )


def test_three_parts_a_file_and_a_time(tmp_path: Path) -> None:
    """A continued run continues, also from its file and from a pickle, and a time of a run is a start, too."""
    whole_case = case(load=LOADS["harmonic"])
    whole = rb.simulate(whole_case)
    first = rb.simulate(whole_case.replaced({"duration": 0.2}))
    second = rb.simulate(whole_case.replaced({"duration": 0.5}), start=first)
    third = rb.simulate(whole_case, start=second)
    assert_same_bits(whole, third)
    saved = second.save(tmp_path / "second.nc")
    assert rb.simulate(whole_case, start=saved) == third
    assert rb.simulate(whole_case, start=pickle.loads(pickle.dumps(second))) == third
    assert rb.simulate(whole_case, start=(whole, "0.5 s")) == third
    assert "which continues a run" in third.provenance.continues
    stored = rb.load(third.save(tmp_path / "third.nc"))
    assert stored.provenance.continues == third.provenance.continues
    assert stored.end is not None
    assert stored.arrays.time[0] == 0.5


def test_stopped_run() -> None:
    """A run that the user stopped continues with the bits of the whole run."""
    whole_case = case(damper=damper(gap="0.05 mm"), duration="4 s", output=rb.Output(rate="50 Hz"))
    stopped = rb.simulate(whole_case, progress=lambda done, total: False)
    if stopped.ok:
        pytest.skip("the run was finished before it could be stopped")
    assert stopped.status == "interrupted"
    assert_same_bits(rb.simulate(whole_case), rb.simulate(whole_case, start=stopped))


def test_the_load_is_switched_off() -> None:
    """Without its load the motion of the run decays: the energy only falls, and starts where the run ended."""
    driven = case(load=LOADS["harmonic"], duration="2 s")
    first = rb.simulate(driven)
    decay = rb.simulate(driven.replaced({"loads": (), "duration": "3 s"}), start=first)
    energy = decay.ledger.motion
    assert energy[0] == pytest.approx(first.ledger.motion[-1], rel=1e-12)
    assert energy[-1] < 0.5 * energy[0]
    assert np.diff(energy).max() < 1e-9 * energy[0]
    assert decay.arrays.load_work.size == 0 or not decay.arrays.load_work.any()
    assert decay.ledger.losses[0] == 0
    assert decay.energy_residual < 1e-8
    values = decay.summary().values
    assert values["supplied_energy"] == pytest.approx(energy[0])
    assert (values["start_time"], values["end_time"]) == (2.0, 3.0)
    assert "2.000 s to 3.000 s" in str(decay.summary())


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("law", ["tsuji", "linear"])
def test_another_stiffness_within_a_contact(law: str, share: float) -> None:
    """A closed contact takes another stiffness; work, losses and energies from there on close to rounding."""
    changed = {"tsuji": rb.Tsuji(restitution=0.5), "linear": rb.Linear(stiffness="30 kN/m", restitution=0.6)}[law]
    whole_case = case(damper=damper(SOFT[law]))
    whole = rb.simulate(whole_case)
    touch = whole.impacts.time.values[4] + share * whole.impacts.duration.values[4]
    run = continued(whole_case, float(touch), **{"damper.contact": changed})
    assert run.energy_residual < 1e-9
    assert run.impacts.time.values[0] == pytest.approx(whole.impacts.time.values[4])
    assert run.arrays.displacement[0] == pytest.approx(whole.arrays.displacement[0], abs=7e-3)


def test_another_structure_keeps_the_motion() -> None:
    """With another mass the points continue where they were, at the velocity that they had, although the modes differ."""
    first = rb.simulate(case(duration=CUT))
    run = rb.simulate(case(structure=oscillator(mass="5 kg")), start=first)
    for name in ("displacement", "velocity", "ball_position", "ball_velocity"):
        assert getattr(run.arrays, name)[0] == pytest.approx(getattr(first.arrays, name)[-1], rel=1e-12), name
    assert run.energy_residual < 1e-9
    assert not np.array_equal(run.arrays.modal_displacement[0], first.arrays.modal_displacement[-1])


def test_modes_that_cannot_take_over_the_motion_are_refused() -> None:
    """A building with all its modes may change its stiffness; with fewer modes of other shapes it is refused."""
    masses, stiffnesses = ["300 kg"] * 3, ["200 kN/m", "150 kN/m", "100 kN/m"]
    push = rb.HalfSine(amplitude="3 kN", duration="0.1 s", point="storey 3")

    def building(duration: float, weaker: float = 1.0, modes: int | None = None) -> rb.Case:
        values = [f"{weaker * 200} kN/m", *stiffnesses[1:]]
        structure = rb.ShearBuilding(masses=masses, stiffnesses=values, damping_ratio=0.01)
        if modes is not None:
            all_modes = structure.modes()
            structure = rb.Modal(
                frequencies=structure.natural_frequencies[:modes],
                damping_ratio=0.01,
                shapes={name: list(shape[:modes]) for name, shape in all_modes.shapes.items()},
            )
        return rb.Case(structure=structure, load=push, duration=duration, output=rb.Output(rate="500 Hz"))

    first = rb.simulate(building(0.5))
    later = rb.simulate(building(1.0, weaker=0.5), start=first)
    for name in ("displacement", "velocity"):
        size = np.abs(getattr(first.arrays, name)[-1]).max()
        assert getattr(later.arrays, name)[0] == pytest.approx(getattr(first.arrays, name)[-1], abs=1e-12 * size)
    assert later.energy_residual < 1e-9
    truncated = rb.simulate(building(0.5, modes=2))
    assert "cannot take over the motion" in refusal(truncated, building(1.0, weaker=0.5, modes=2))
    assert rb.simulate(building(1.0, modes=2), start=truncated).ok


def test_a_changed_rate_of_decay_agrees_with_theory() -> None:
    """An oscillator whose damping changes at the seam decays with the new rate from there on, in closed form."""
    bare: dict[str, Any] = {"structure": oscillator(), "duration": "0.5 s", "output": rb.Output(rate="1 kHz")}
    first = rb.simulate(rb.Case(**bare))
    zeta, omega = 0.05, 2 * np.pi * 17
    second = rb.simulate(
        rb.Case(**bare | {"structure": oscillator(damping_ratio=zeta), "duration": "1 s"}), start=first
    )
    t = second.arrays.time - 0.5
    x, v = first.arrays.displacement[-1, 0], first.arrays.velocity[-1, 0]
    damped = omega * np.sqrt(1 - zeta**2)
    exact = np.exp(-zeta * omega * t) * (x * np.cos(damped * t) + (v + zeta * omega * x) / damped * np.sin(damped * t))
    assert second.arrays.displacement[:, 0] == pytest.approx(exact, abs=1e-12)


def refusal(first: rb.Run, changed: rb.Case, start: Any = None) -> str:
    """Return the message with which a case is refused."""
    with pytest.raises(rb.RattleboxError) as raised:
        rb.simulate(changed, start=first if start is None else start)
    return str(raised.value)


def test_what_is_refused() -> None:
    """Each thing that a run cannot follow is named, with what is allowed and what to try."""
    whole_case = case()
    whole = rb.simulate(whole_case)
    first = rb.simulate(case(duration=CUT))
    touch = float(whole.impacts.time.values[4] + 0.4 * whole.impacts.duration.values[4])
    touching = rb.simulate(case(duration=touch))
    assert "must end later" in refusal(first, case(duration=CUT))
    assert "the method is newton" in refusal(first, case(method=rb.Newton()))
    assert "1 impact damper with 2 balls, the run 1 impact damper with 1 ball" in refusal(
        first, case(damper=damper(count=2))
    )
    assert "the case has no impact damper, the run 1" in refusal(first, case(damper=None))
    assert "is closed at the end of the run" in refusal(touching, case(damper=damper(gap="1.2 mm")))
    assert "another kind of law" in refusal(touching, case(damper=damper(SOFT["linear"])))
    renamed = rb.Modal(frequencies=[20.0], damping_ratios=[0.01], shapes={"tip": [0.5]})
    assert "1 point (tip), that of the run 1 mode and 1 point (mass)" in refusal(first, case(structure=renamed))
    assert "TwoStep" in refusal(first, case(method=rb.TwoStep()))
    two_step = rb.simulate(case(duration="10 ms", method=rb.TwoStep()))
    assert "TwoStep" in refusal(two_step, case())
    assert "must be after 0 s and up to 0.31 s" in refusal(first, case(), (first, "0.4 s"))
    assert "a run and a time" in refusal(first, case(), (first, 0.1, 0.2))
    assert "start must be a run" in refusal(first, case(), 3)
    later = rb.simulate(case(duration="0.5 s"), start=first)
    assert "continues another one" in refusal(later, case(), (later, "0.4 s"))
    other = replace(first, end=replace(first.end, core="v9"))
    assert "with the core v9" in refusal(other, case())
    assert "no state" in refusal(replace(first, end=None), case())
    assert first.end is not None
    assert first.end.arrays is not None
    cut_short = replace(first.end, arrays={**first.end.arrays, "whole": first.end.arrays["whole"][:-3]})
    assert "the state is cut short" in refusal(replace(first, end=cut_short), case())
    assert "status energy_error" in refusal(replace(first, status="energy_error"), case())
    with pytest.raises(rb.CaseError, match="no checkpoints"):
        rb.simulate(case(), start=first, checkpoint="run.checkpoint")


def test_a_gap_that_is_too_small_is_refused_with_its_value() -> None:
    """A smaller gap that an open contact does not leave is refused, and the advice works when it is followed once."""
    first = rb.simulate(case(duration=CUT))
    message = refusal(first, case(damper=damper(gap="0.02 mm")))
    match = re.search(r"would overlap by ([\d.]+ \w?m).*a gap that is larger by", message, re.DOTALL)
    assert match, message
    amount, unit = match[1].split()
    more = float(amount) * {"mm": 1e-3, "um": 1e-6, "nm": 1e-9}[unit]
    assert rb.simulate(case(damper=damper(gap=(0.02e-3 + more) * 1.001)), start=first).ok


# ---- particles


def fifty_balls(**changes: Any) -> rb.ParticleDamper:
    """Return fifty balls with friction and rolling resistance in a box."""
    parts: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="5 mm", count=50),
        "cavity": rb.Box(size=("25 mm", "25 mm", "25 mm")),
        "contact": rb.Tsuji(restitution=0.7),
        "friction": 0.3,
        "rolling": 0.01,
        "direction": "z",
        "packing": rb.Settled(seed=1),
        "softening": 200,
    }
    return rb.ParticleDamper(**(parts | changes))


def bed(**changes: Any) -> rb.Case:
    """Return a bed on a driven oscillator."""
    parts: dict[str, Any] = {
        "structure": rb.SDOF(mass="1 kg", frequency="30 Hz", damping_ratio=0.01),
        "damper": fifty_balls(),
        "load": rb.Harmonic(amplitude="9 N", frequency="30 Hz"),
        "duration": "0.2 s",
        "output": rb.Output(rate="500 Hz"),
        "method": rb.Dem(dt=2.5e-6),
    }
    return rb.Case(**(parts | changes))


BED = ("displacement", "velocity", "momentum", "kinetic_energy", "rotation_energy", "contact_energy", "contacts")


def test_bed_with_history(tmp_path: Path) -> None:
    """A bed with friction continues with the same bits, in three parts, from a file and from a time of the whole run."""
    whole = rb.simulate(bed())
    first = rb.simulate(bed(duration="0.1 s"))
    assert first.diagnostics["step"] == whole.diagnostics["step"]
    later = rb.simulate(bed(), start=first)
    middle = later.arrays.time.size
    assert later.arrays.time.tobytes() == whole.arrays.time[-middle:].tobytes()
    for name in BED:
        assert getattr(later.arrays, name).tobytes() == getattr(whole.arrays, name)[-middle:].tobytes(), name
    assert later.arrays.particles == whole.arrays.particles
    assert later.energy_residual < 1e-3
    assert later.arrays.load_work[0] == later.arrays.sliding_loss[0].sum() == 0
    assert later.counts["steps"] == first.counts["steps"]
    again = rb.load(first.save(tmp_path / "first.nc"))
    second = rb.simulate(bed(duration="0.15 s"), start=again)
    third = rb.simulate(bed(), start=second)
    assert third.arrays.particles == whole.arrays.particles
    assert rb.simulate(bed(), start=(whole, "0.1 s")).arrays.particles == whole.arrays.particles


def test_bed_without_its_load() -> None:
    """A bed whose load ends comes to rest in absolute time, with a balance of energy from the seam on."""
    first = rb.simulate(bed(duration="0.1 s"))
    decay = rb.simulate(bed(load=None, duration="0.3 s"), start=first)
    assert decay.ok, decay.message
    assert decay.arrays.time[0] == first.arrays.time[-1]
    assert decay.arrays.time[-1] == pytest.approx(0.3, rel=1e-9)
    assert decay.energy_residual < 1e-3
    assert decay.ledger.motion[0] == pytest.approx(first.ledger.motion[-1], rel=1e-9)
    assert decay.ledger.motion[-1] < 0.5 * decay.ledger.motion[0]
    assert not decay.arrays.load_work.any()
    further = rb.simulate(bed(load=None, duration="0.35 s"), start=decay)
    whole = rb.simulate(bed(load=None, duration="0.35 s"), start=first)
    assert further.arrays.time[-1] == pytest.approx(whole.arrays.time[-1], rel=1e-12)
    assert further.arrays.particles == whole.arrays.particles


def test_bed_in_another_gravity() -> None:
    """A bed on its side in the next part falls, and the potential energy of the first sample is that of the new gravity."""
    first = rb.simulate(bed(load=None, duration="20 ms"))
    turned = rb.simulate(bed(damper=fifty_balls(gravity=(9.81, 0, 0)), load=None, duration="60 ms"), start=first)
    assert turned.ok, turned.message
    assert turned.energy_residual < 1e-3
    assert turned.arrays.gravity_energy[-1, 0] < turned.arrays.gravity_energy[0, 0] - 1e-5


def test_a_load_that_begins_after_the_seam_acts_at_its_time() -> None:
    """A pulse at an absolute time after the seam acts at that time, although the case has changed."""
    first = rb.simulate(bed(load=None, duration="0.05 s"))
    pulse = rb.HalfSine(amplitude="80 N", duration="10 ms", start="0.07 s")
    run = rb.simulate(bed(load=pulse, duration="0.12 s"), start=first)
    force = run.arrays.load[:, 0]
    assert run.arrays.time[force > 0].min() == pytest.approx(0.07, abs=2.1e-3)
    speed = np.abs(run.arrays.velocity[:, 0])
    assert speed[run.arrays.time < 0.0699].max() < 0.01 * speed[run.arrays.time > 0.08].max()


def test_what_a_bed_cannot_follow() -> None:
    """Other particles, cavities, stiffnesses and kinds of dampers are refused by name."""
    first = rb.simulate(bed(duration="20 ms"))
    changes: dict[str, Any] = {
        "stiffness of contacts": {"softening": 100},
        "the particles of the run cannot change": {
            "particles": rb.Particles(material="aluminium", diameter="5 mm", count=50)
        },
        "the cavity": {"cavity": rb.Box(size=("25 mm", "25 mm", "30 mm"))},
        # another number ended in a ValueError of NumPy: the other particles here were as many
        "has 51 particles, that of the run 50": {
            "particles": rb.Particles(material="steel", diameter="5 mm", count=51)
        },
    }
    for what, change in changes.items():
        assert what in refusal(first, bed(damper=fifty_balls(**change))), what
    assert "both have particle dampers" in refusal(first, case())
    assert "mode shapes of the structure differ" in refusal(first, bed().replaced({"structure.mass": "1.5 kg"}))
    assert rb.simulate(bed(damper=fifty_balls(friction=0.2), duration="30 ms"), start=first).ok


def test_a_bed_takes_another_time_step() -> None:
    """A time step that the case states is taken, also if nothing else changes; only other changes had a test."""
    first = rb.simulate(bed(duration="20 ms"))
    dt = first.diagnostics["step"] / 2
    finer = bed(duration="40 ms", method=rb.Dem(dt=dt))
    rest = rb.simulate(finer, start=first)
    assert rest.diagnostics["step"] <= dt * (1 + 1e-9)
    assert rest.ok
    again = rb.simulate(finer.replaced({"duration": "60 ms"}), start=rest)
    whole = rb.simulate(finer.replaced({"duration": "60 ms"}), start=first)
    common = whole.arrays.time > again.arrays.time[0] - 1e-9
    assert again.diagnostics["step"] == rest.diagnostics["step"]
    largest = np.abs(whole.arrays.displacement).max()
    np.testing.assert_allclose(again.arrays.displacement, whole.arrays.displacement[common], atol=1e-9 * largest)


def test_a_settled_bed_floats_without_gravity() -> None:
    """A bed that has settled continues without gravity, with the packing that such a case needs: its place was refused."""
    first = rb.simulate(bed(duration="20 ms"))
    floating = bed(duration="40 ms").replaced({"damper.gravity": [0, 0, 0], "damper.packing": rb.Lattice()})
    rest = rb.simulate(floating, start=first)
    assert rest.ok
    np.testing.assert_array_equal(rest.arrays.displacement[0], first.arrays.displacement[-1])
    np.testing.assert_array_equal(rest.arrays.momentum[0], first.arrays.momentum[-1])
    assert not rest.ledger.gravity.any()
