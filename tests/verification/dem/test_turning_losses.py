"""Losses of turning, meshed and divided cavities: the work of the structure, without that of the drive.

Losses were compared with other losses of the same run, so that work of the drive in both would not have been seen.
"""

from typing import Any

import numpy as np
import pytest
from support.triangle_meshes import box

import rattlebox as rb
from rattlebox.analysis.cycle_loss import cycle_loss

FREQUENCY = 60.0
ABOUT_X = {
    "steady": rb.Rotation(speed="600 rpm", axis="x", arm=(0, 0, 0)),
    "rocking": rb.Rotation(amplitude="20 deg", frequency="7 Hz", axis="x", arm=(0, 0, 0)),
}
WEDGE = rb.Mesh(vertices=box((24, 18, 16))[0], faces=box((24, 18, 16))[1], unit="mm")


def smooth_can(rotation: rb.Rotation | None, structure: Any) -> rb.Case:
    """Return one ball, beside the axis, in a can without friction that vibrates along its axis."""
    return rb.Case(
        structure=structure,
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="steel", diameter="6 mm", count=1),
            cavity=rb.Cylinder(diameter="20 mm", length="12 mm", axis="x"),
            contact=rb.Tsuji(restitution=0.5),
            gravity=(0, 0, 0),
            packing=rb.Lattice(seed=1, noise=0.8),
            rotation=rotation,
            softening=200,
        ),
        duration="0.5 s",
        method=rb.Dem(dt="4 us"),
    )


@pytest.mark.parametrize("motion", list(ABOUT_X))
def test_rotation_about_the_line_of_vibration_changes_no_loss(motion: str) -> None:
    """A smooth can that turns about its axis pushes a ball along it as one at rest: the same damping ratios."""
    mass = rb.SDOF(mass="0.1 kg", frequency="60 Hz", damping_ratio=0.005)
    for way, options in {"decay": {}, "energy": {}, "shaking": {"cycles": (10, 20)}}.items():
        still, turning = (
            rb.damping_curve(
                smooth_can(rotation, mass), ["2 mm", "4 mm"], way=way, packings=2, progress=False, **options
            ).damping_ratio.values
            for rotation in (None, ABOUT_X[motion])
        )
        assert np.isfinite(still[1]) and np.allclose(turning, still, rtol=1e-5, equal_nan=True)


def test_map_of_a_can_that_turns_about_the_line_of_vibration() -> None:
    """The loss map and the measures of a sweep of a smooth can are those of one at rest."""
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="200 m/s^2", frequency="60 Hz", direction="x"))
    results = []
    for rotation in (None, *ABOUT_X.values()):
        case = smooth_can(rotation, shaker)
        table = rb.loss_map(case, amplitudes=["400 m/s^2"], frequencies=["60 Hz"], cycles=(10, 20), progress=False)
        swept = rb.sweep(case, {"seed": [0]}, ["reduced_loss", "effective_mass"], cycles=(10, 20), progress=False)
        results.append([table.damping_mass.item(), swept.reduced_loss.item(), swept.effective_mass.item()])
    assert results[0][1] > 1
    assert np.allclose(results[1:], results[0], rtol=1e-5)


def rough(**changes: Any) -> rb.Case:
    """Return a bed with friction on an oscillator at resonance."""
    values: dict[str, Any] = {
        "particles": rb.Particles(material="steel", diameter="4 mm", count=25),
        "cavity": rb.Cylinder(diameter="22 mm", length="16 mm", axis="y"),
        "contact": rb.Tsuji(restitution=0.6),
        "friction": 0.3,
        "packing": rb.Settled(seed=2),
        "softening": 1000,
    }
    return rb.Case(
        structure=rb.SDOF(mass="0.4 kg", frequency=FREQUENCY, damping_ratio=0.01),
        damper=rb.ParticleDamper(**(values | changes)),
        load=rb.Harmonic(amplitude="6 N", frequency=FREQUENCY),
        duration="0.25 s",
        output=rb.Output(rate="12 kHz"),
    )


GEAR = rb.Rotation(speed="100 rpm", axis="y", arm=("150 mm", 0, 0))
BLADE = rb.Rotation(speed="100 rpm", axis="y", arm=("150 mm", 0, 0), vibration="cavity")


@pytest.mark.parametrize(
    ("changes", "drives"),
    [
        ({"rotation": GEAR}, True),
        ({"rotation": BLADE}, True),
        ({"rotation": GEAR, "cavity": WEDGE}, True),
        ({"rotation": GEAR, "bodies": [rb.RodBody(diameter="6 mm", axis="y")]}, True),
        ({"rotation": GEAR, "offsets": [["-15 mm", 0, 0], ["15 mm", 0, 0]]}, True),
        ({"cavity": WEDGE, "bodies": [rb.BallBody(diameter="5 mm")]}, False),
        ({"offsets": [["-15 mm", 0, 0], ["15 mm", 0, 0]], "bodies": [rb.BodyCross(thickness="1 mm", axis="y")]}, False),
    ],
    ids=[
        "gear",
        "blade",
        "mesh in a gear",
        "rod in a gear",
        "cells of a gear",
        "mesh with a ball",
        "cells with a cross",
    ],
)
def test_loss_is_what_the_structure_loses(changes: dict[str, Any], drives: bool) -> None:
    """The loss of the last cycles is what load, dashpot and energy of the structure leave, whatever the drive supplies."""
    run = rb.simulate(rough(**changes))
    arrays, cycles = run.arrays, 6
    loss = cycle_loss(run, FREQUENCY, cycles).work
    left = arrays.load_work - run.ledger.channels["viscous"] - run.ledger.structure
    ends = arrays.time[-1] - np.array([cycles, 0]) / FREQUENCY
    given = float(np.diff(np.interp(ends, arrays.time, left))[0]) / cycles
    assert loss == pytest.approx(given, rel=2e-3)
    # What the drive gives and takes back, since the rest over some cycles may be small by chance.
    exchanged = np.abs(np.diff(arrays.drive_work.sum(axis=1)[arrays.time >= ends[0]])).sum() / cycles
    assert (exchanged > 20e-3 * abs(given)) == drives


def turning(rotation: rb.Rotation, structure: Any, duration: Any = "50 ms", **changes: Any) -> rb.Case:
    """Return a small bed in a can that turns about y, moved along z."""
    bed = {"packing": rb.Settled(seed=1), "rotation": rotation, "direction": "z"}
    return rough(**(bed | changes)).model_copy(
        update={
            "structure": structure,
            "duration": rb.Case(structure=rb.Fixed(), duration=duration).duration,
            "loads": (),
            "output": rb.Output(rate=24 * FREQUENCY),
        }
    )


def test_shaking_along_axes_that_turn_is_refused() -> None:
    """A shaker moves along axes of the machine; the check of cases was skipped where a study puts the damper on one."""
    blade = rb.Rotation(speed="600 rpm", axis="y", arm=("60 mm", 0, 0), vibration="cavity")
    case = turning(blade, rb.SDOF(mass="1 kg", frequency="60 Hz", damping_ratio=0.01))
    with pytest.raises(
        rb.CaseError, match=r"along those of the cavity\n  try: vibration = \"machine\", or way = 'decay'"
    ):
        rb.damping_curve(case, ["0.1 mm", "0.2 mm"], way="shaking", progress=False)
    data = rb.ShakerLoss(amplitude=["20 m/s^2"], frequency=["60 Hz"], loss_factor=[0.5], error="5 %", cycles=(2, 2))
    with pytest.raises(rb.CaseError, match="along those of the cavity"):
        rb.calibrate(data, case, {"damper.friction": (0.1, 0.5)}, progress=False)


@pytest.mark.parametrize(
    ("rotation", "gravity", "turns"),
    [
        (rb.Rotation(speed="360 rpm", axis="y", arm=("60 mm", 0, 0)), 0, 0.6),
        (rb.Rotation(speed="600 rpm", axis="y", arm=("60 mm", 0, 0)), 0, None),
        (rb.Rotation(speed="360 rpm", axis="z", arm=("60 mm", 0, 0)), 0, None),
        (rb.Rotation(speed="360 rpm", axis="z", arm=(0, 0, 0)), -9.81, 0.6),
        (rb.Rotation(amplitude="10 deg", frequency="4 Hz", axis="y", arm=("60 mm", 0, 0)), 0, 0.4),
        (rb.Rotation(amplitude="10 deg", frequency="20 Hz", axis="y", arm=("60 mm", 0, 0)), 0, None),
    ],
)
def test_part_of_a_turn_is_not_a_steady_loss(rotation: rb.Rotation, gravity: float, turns: float | None) -> None:
    """The mean loss over a part of a turn depends on the angle of its start, and had an interval as a steady one."""
    shaker = rb.Shaker(motion=rb.Harmonic(amplitude="30 m/s^2", frequency="60 Hz", direction="z"))
    case = turning(rotation, shaker, "0.15 s", packing=rb.Lattice(seed=1), gravity=(gravity, 0, 0))
    loss = cycle_loss(rb.simulate(case), FREQUENCY, 6)
    assert loss.is_whole_turn == (turns is None)
    if turns:
        assert (
            not loss.is_steady and f"try: a mean over whole turns, {int(np.ceil(6 / turns))} cycles" in loss.warning()
        )


def test_energy_of_turning_at_the_start_is_noted() -> None:
    """A note states m (W R)^2 / 2 at the start, which made shares of the energy supplied small without a word."""
    blade = rb.Rotation(speed=60.0, axis="y", arm=("70 mm", "10 mm", 0))
    case = turning(blade, rb.Fixed(), "1 ms", packing=rb.Lattice(seed=1))
    energy = 0.5 * case.particle_dampers[0].mass * (60 * 0.07) ** 2
    (note,) = [note for note in rb.simulate(case).notes if note.startswith("the energy supplied contains")]
    assert float(note.split()[4]) == pytest.approx(1e3 * energy, rel=1e-3) and note.split()[5] == "mJ"
    assert not any("energy supplied" in note for note in rb.simulate(turning(None, rb.Fixed(), "1 ms")).notes)
