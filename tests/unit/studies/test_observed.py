"""Measures of drifts, modes, relative accelerations and forces, against the responses of a run."""

from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.analysis import drift

TOWER = rb.ShearBuilding(masses=["50 t"] * 3, stiffnesses=["60 MN/m"] * 3, damping_ratio="2 %")
BASE = rb.Harmonic(amplitude="0.1 g", frequency="2 Hz")
MEASURES = [
    f"{what}{name}"
    for name in ("", "_velocity", "_acceleration", "_relative_acceleration", "_damper_force", "_interface_force")
    for what in ("peak", "rms")
]


def impact_case() -> rb.Case:
    """Return a building with a heavy ball on top."""
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="0.85 m", mass="2500 kg", material="steel"),
        gap="20 mm",
        contact=rb.Linear(contact_time="20 ms", restitution=0.5),
        point="storey 3",
    )
    tuned = rb.TunedMass.warburton(TOWER, mass="1 t", point="storey 3")
    return rb.Case(
        structure=TOWER, base=BASE, damper=ball, tuned_mass=tuned, duration="4 s", output=rb.Output(rate="500 Hz")
    )


def particle_case() -> rb.Case:
    """Return a building with six balls in a box on top."""
    balls = rb.ParticleDamper(
        particles=rb.Particles(material="steel", diameter="0.4 m", count=6),
        cavity=rb.Box(size=("1.3 m", "0.9 m", "0.5 m")),
        contact=rb.Linear(contact_time="20 ms", restitution=0.5),
        friction=rb.LinearSpring(coefficient=0.3, ratio=0.286),
        packing=rb.Lattice(noise=0.5, seed=1),
        point="storey 3",
        direction="x",
    )
    return rb.Case(structure=TOWER, base=BASE, damper=balls, duration="2 s", output=rb.Output(rate="500 Hz"))


def of_run(run: rb.Run, motion: tuple[Any, Any, Any], base: Any) -> dict[str, float]:
    """Return the measures of a motion and of the forces, from the variables of the run."""
    displacement, velocity, acceleration = (np.asarray(each) for each in motion)
    cavity, interface = (run.motion[name].values for name in ("cavity_force", "interface_force"))
    if cavity.ndim == 3:
        cavity, interface = np.linalg.norm(cavity.sum(axis=1), axis=1), np.linalg.norm(interface, axis=1)
    series = {
        "": displacement,
        "_velocity": velocity,
        "_relative_acceleration": acceleration,
        "_acceleration": acceleration + base,
        "_interface_force": interface,
    }
    return {f"peak{name}": np.abs(x).max() for name, x in series.items()} | {
        f"rms{name}": np.sqrt(np.mean(x**2)) for name, x in series.items()
    }


@pytest.mark.parametrize("make", [impact_case, particle_case])
@pytest.mark.parametrize("point", ["storey 3", "storey 2 - storey 1", "mode 2"])
def test_measures_are_those_of_the_responses(make: Any, point: str) -> None:
    """Points, drifts and modes of a sweep have the values of the variables of a run, in their units."""
    case = make()
    run = rb.simulate(case)
    result = rb.sweep(
        case, {"base.amplitude": [BASE.amplitude]}, MEASURES, samples=run.motion.sizes["time"], point=point
    )
    motion = run.motion
    if point == "mode 2":
        rate = np.gradient(motion.modal_velocity[:, 1], motion.time)
        own: Any = (motion.modal_displacement[:, 1], motion.modal_velocity[:, 1], rate)
    elif point == "storey 3":
        own = tuple(motion[name].sel(point=point) for name in ("displacement", "velocity", "acceleration"))
    else:
        of_points = motion[["velocity", "acceleration"]]
        apart = of_points.sel(point="storey 2") - of_points.sel(point="storey 1")
        own = (drift(run, "storey 2", "storey 1"), apart.velocity, apart.acceleration)
    base = motion.base_acceleration.values.reshape(motion.sizes["time"], -1)[:, 0] * (point == "storey 3")
    for name, expected in of_run(run, own, base).items():
        # Accelerations have the mean of the contact force over a step in place of that at the samples.
        allowed = 0.02 if "acceleration" in name else 1e-6 if name.startswith("peak") else 2e-3
        assert float(result[name][0]) == pytest.approx(float(expected), rel=allowed), name
    assert result["peak"].attrs["units"] == ("kg^0.5 m" if point == "mode 2" else "m")
    assert result["peak_interface_force"].attrs["units"] == "N"


@pytest.mark.parametrize("make", [impact_case, particle_case])
def test_the_damper_force_is_the_mean_of_the_contact_force(make: Any) -> None:
    """The force that the momentum of the balls lacks is the contact force, averaged over a sample step."""
    case = make()
    fine = rb.simulate(case.model_copy(update={"output": rb.Output(rate="20 kHz")}))
    force = fine.motion.cavity_force.sum("damper").values
    count = 1 + (force.shape[0] - 1) // 40
    means = np.array(
        [
            (force[40 * k] / 2 + force[40 * k + 1 : 40 * k + 40].sum(0) + force[40 * k + 40] / 2) / 40
            for k in range(count - 1)
        ]
    )
    size = np.linalg.norm(means, axis=1) if means.ndim == 2 else np.abs(means)
    result = rb.sweep(
        case, {"base.amplitude": [BASE.amplitude]}, ["peak_damper_force", "rms_damper_force"], samples=count
    )
    assert float(result.peak_damper_force[0]) == pytest.approx(size.max(), rel=0.02)
    assert float(result.rms_damper_force[0]) == pytest.approx(np.sqrt(np.mean(size**2)), rel=0.02)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"point": "storey 9"}, "storey"),
        ({"point": "storey 2 - storey 9"}, "drift"),
        ({"point": "mode 7"}, "mode 4"),
    ],
)
def test_unknown_points(options: dict[str, Any], message: str) -> None:
    """The message names the point and what can be observed."""
    with pytest.raises(rb.CaseError, match=message):
        rb.sweep(impact_case(), {"base.amplitude": [1.0]}, ["rms"], **options)


def test_the_force_on_the_base_needs_participation() -> None:
    """Structures without participation, and fixed ones, are refused with what to do."""
    modal = rb.Modal(frequencies=[10.0], damping_ratios=[0.01], shapes={"tip": [1.0]})
    load = rb.Harmonic(amplitude=1.0, frequency=10.0)
    for structure, word in ((modal, "participation"), (rb.Fixed(), "peak_damper_force")):
        loads = {"load": load} if structure is modal else {}
        case = rb.Case(
            structure=structure,
            damper=impact_case().dampers[0].model_copy(update={"point": None}),
            duration=1.0,
            **loads,
        )
        with pytest.raises(rb.CaseError, match=word):
            rb.sweep(case, {"damper.gap": ["10 mm"]}, ["rms_interface_force"])


def test_studies_over_masses() -> None:
    """The force on the base over the masses of the structure and of a tuned mass is that of single runs."""
    case = rb.Case(
        structure=rb.SDOF(mass="4 kg", frequency="10 Hz", damping_ratio=0.02),
        tuned_mass=rb.TunedMass(mass="0.2 kg", frequency="9 Hz", damping_ratio=0.1),
        base=rb.Harmonic(amplitude="3 m/s^2", frequency="10 Hz"),
        duration="1 s",
        output=rb.Output(rate=1000.0),
    )
    axes: dict[str, Any] = {"structure.mass": [2.0, 4.0], "tuned_mass.mass": [0.1, 0.3, 0.5]}
    result = rb.sweep(case, axes, ["peak_interface_force"], samples=1001)
    for i, mass in enumerate(axes["structure.mass"]):
        for j, tuned in enumerate(axes["tuned_mass.mass"]):
            one = case.model_copy(
                update={
                    "structure": case.structure.model_copy(update={"mass": mass}),
                    "tuned_masses": (case.tuned_masses[0].model_copy(update={"mass": tuned}),),
                }
            )
            expected = float(abs(rb.simulate(one).motion.interface_force).max())
            assert float(result.peak_interface_force[i, j]) == pytest.approx(expected, rel=1e-9)


def test_a_frequency_response_of_a_mode_has_its_unit() -> None:
    """The amplitude of a mode is in kg^0.5 m, and agrees with the closed form without damper."""
    case = impact_case().model_copy(update={"dampers": (), "tuned_masses": ()})
    result = rb.frequency_response(case, [2.0, 2.5], point="mode 1", cycles=(60, 8))
    assert result.amplitude.attrs["units"] == result.bare_amplitude.attrs["units"] == "kg^0.5 m"
    np.testing.assert_allclose(result.amplitude.sel(direction="up"), result.bare_amplitude, rtol=1e-3)
