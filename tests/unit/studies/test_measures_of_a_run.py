"""Measures over all storeys and points: the largest drift and the largest acceleration."""

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import largest_acceleration, largest_drift

TOWER = rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=["60 MN/m", "50 MN/m", "40 MN/m"], damping_ratio="2 %")
QUAKE = rb.Harmonic(amplitude="0.1 g", frequency="2 Hz")
BALL = rb.ImpactDamper(
    ball=rb.Sphere(diameter="0.85 m", mass="2500 kg", material="steel"),
    gap="20 mm",
    contact=rb.Linear(contact_time="20 ms", restitution=0.5),
    point="storey 3",
)
BALLS = rb.ParticleDamper(
    particles=rb.Particles(material="steel", diameter="0.4 m", count=4),
    cavity=rb.Box(size=("1.3 m", "0.9 m", "0.5 m")),
    contact=rb.Tsuji(restitution=0.5),
    packing=rb.Settled(seed=1),
    softening=1e4,
    point="storey 3",
    direction="x",
)
NAMES = ["largest_drift", "largest_acceleration"]
DRIFTS = ("storey 1", "storey 2 - storey 1", "storey 3 - storey 2")


def case_of(damper: Any, **options: Any) -> rb.Case:
    """Return a building under a harmonic base motion with a tuned mass on its roof and a damper."""
    direction = {"direction": "x"} if isinstance(damper, rb.ParticleDamper) else {}
    base = QUAKE.model_copy(update=direction)
    tuned = rb.TunedMass.warburton(TOWER, mass="1 t", point="storey 3")
    return rb.Case(
        structure=TOWER,
        base=rb.Harmonic(amplitude=base.amplitude, frequency=base.frequency, **direction),
        dampers=[damper] if damper else [],
        tuned_mass=tuned,
        duration="3 s",
        **options,
    )


@pytest.mark.parametrize("damper", [None, BALL, BALLS], ids=["bare", "ball", "particles"])
def test_studies_and_single_runs_have_the_same_largest_values(damper: Any) -> None:
    """A sweep returns the bits of the functions of a run and of its summary, with both engines and without a damper."""
    case = case_of(damper)
    study = rb.sweep(case, {"base.amplitude": ["0.1 g", "0.3 g"]}, NAMES, progress=False)
    for index, amplitude in enumerate((0.1, 0.3)):
        run = rb.simulate(
            case.model_copy(
                update={"base": tuple(b.model_copy(update={"amplitude": amplitude * 9.80665}) for b in case.base)}
            )
        )
        summary = run.summary().values
        for name, function in (("largest_drift", largest_drift), ("largest_acceleration", largest_acceleration)):
            assert float(study[name][index]) == function(run) == summary[name], name
    assert study.largest_drift.attrs["units"] == "m" and study.largest_acceleration.attrs["units"] == "m/s^2"


@pytest.mark.parametrize("damper", [BALL, BALLS], ids=["ball", "particles"])
def test_the_largest_values_are_those_of_the_points(damper: Any) -> None:
    """In a window after a transient they are the largest measures of single drifts and floors with the same samples."""
    case = case_of(damper, output=rb.Output(rate="500 Hz"))
    axes = {"base.amplitude": ["0.2 g"]}
    all_points = rb.sweep(case, axes, NAMES, skip="1 s", progress=False)

    def largest(measure: str, points: tuple[str, ...]) -> float:
        options: dict[str, Any] = {"skip": "1 s", "samples": 1001, "progress": False}
        return max(float(rb.sweep(case, axes, [measure], point=point, **options)[measure][0]) for point in points)

    floors = ("storey 1", "storey 2", "storey 3")
    # A 1-D run has further samples at contacts, so that its peaks can be a little larger.
    assert float(all_points.largest_drift[0]) == pytest.approx(largest("peak", DRIFTS), rel=1e-4)
    expected = largest("peak_acceleration", floors)
    assert float(all_points.largest_acceleration[0]) == pytest.approx(expected, rel=0.02)
    assert largest("peak_acceleration", ("tuned mass",)) > 1.2 * expected


def test_slow_motion_has_the_static_drift() -> None:
    """Under a slow acceleration each storey carries the masses above it, and all floors move with the base."""
    base = rb.Harmonic(amplitude="1 m/s^2", frequency="0.01 Hz")
    case = rb.Case(structure=TOWER, base=base, duration="100 s", output=rb.Output(rate="20 Hz"))
    study = rb.sweep(case, {"base.amplitude": [1.0]}, NAMES, skip="20 s", progress=False)
    static = max(3 * 50e3 / 60e6, 2 * 50e3 / 50e6, 50e3 / 40e6)
    assert float(study.largest_drift[0]) == pytest.approx(static, rel=2e-3)
    assert float(study.largest_acceleration[0]) == pytest.approx(1.0, rel=2e-3)


def test_drifts_need_storeys_and_continuations_refuse_them() -> None:
    """A drift without storeys raises before anything runs, and so does a continuation; an acceleration needs one point."""
    mass = rb.SDOF(mass="20 kg", frequency="10 Hz")
    box = rb.Case(structure=mass, base=QUAKE, duration="1 s")
    with pytest.raises(rb.CaseError, match="needs all floors of a building"):
        rb.sweep(box, {"base.amplitude": [1.0]}, ["largest_drift"], progress=False)
    with pytest.raises(rb.CaseError, match="needs all floors of a building"):
        largest_drift(rb.simulate(box))
    assert float(rb.sweep(box, {"base.amplitude": [1.0]}, ["largest_acceleration"]).largest_acceleration[0]) > 0.5
    for upper in (3, 10):  # of a model with some floors, that of the first one counted as the largest of all
        shapes = {"storey 1": [0.01, 0.02], f"storey {upper}": [0.02, -0.01]}
        some = rb.Modal(frequencies=[2, 6], damping_ratio=0.02, shapes=shapes, participation=[60, 20])
        run = rb.simulate(box.model_copy(update={"structure": some}), progress=False)
        with pytest.raises(rb.CaseError, match="needs all floors of a building"):
            largest_drift(run)
        assert "drift" not in str(run.summary())
    shaken = rb.reference_case(duration=1.0).model_copy(
        update={"structure": rb.Shaker(motion=rb.Harmonic(amplitude="1 mm", frequency="5 Hz")), "loads": ()}
    )
    shaking = rb.sweep(shaken, {"damper.gap": ["1 mm"]}, ["largest_acceleration"], progress=False)
    assert float(shaking.largest_acceleration[0]) == pytest.approx(1e-3 * (2 * np.pi * 5) ** 2, rel=1e-3)
    with pytest.raises(rb.CaseError, match="in a continuation"):
        rb.bifurcation(case_of(BALL), "base.amplitude", [1.0, 2.0], measure=["largest_drift"], progress=False)


def test_cycles_choose_the_window() -> None:
    """With cycles, the largest values are those of the evaluated cycles, not of the transient."""
    case = case_of(BALL)
    study = rb.sweep(case, {"base.frequency": [1.5, 2.0]}, NAMES, cycles=(4, 2), progress=False)
    for index, frequency in enumerate((1.5, 2.0)):
        base = tuple(each.model_copy(update={"frequency": frequency}) for each in case.base)
        run = rb.simulate(case.model_copy(update={"base": base, "duration": 6 / frequency}))
        late = run.arrays.time >= 4 / frequency
        drifts = np.diff(run.arrays.displacement[late][:, :3], axis=1, prepend=0.0)
        assert float(study.largest_drift[index]) == pytest.approx(np.abs(drifts).max(), rel=1e-6)


def test_structures_of_an_axis_without_the_point() -> None:
    """A variant whose structure lacks the observed point or the storeys raised a KeyError."""
    case = case_of(None).model_copy(update={"tuned_masses": ()})
    mass = rb.SDOF(mass="1 t", frequency="2 Hz")
    for options, message in (
        ({"point": "storey 1"}, "has no point 'storey 1'"),
        ({}, "needs all floors of a building"),
    ):
        measures = ["peak"] if options else ["largest_drift"]
        with pytest.raises(rb.CaseError, match=message):
            rb.sweep(case, {"structure": [TOWER, mass]}, measures, progress=False, **options)
    study = rb.sweep(case, {"structure": [TOWER, mass]}, ["largest_acceleration"], progress=False)
    assert (study.largest_acceleration > 0.5).all()
