"""Damping that couples modes, and tuned masses: against matrix exponentials, the ledger, other methods and engines."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import minimize_scalar

import rattlebox as rb

Array = NDArray[np.float64]

MASS = np.array([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]])
STIFFNESS = 1e4 * np.array([[3.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
DASHPOTS = {
    "one dashpot": np.diag([0.0, 0.0, 8.0]),
    "between two": 20.0 * np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]),
    "heavy": np.diag([0.0, 900.0, 0.0]),
    "one that holds a mass": np.diag([0.0, 0.0, 3e4]),
}


def structure(damping: Array, **options: Any) -> rb.Matrices:
    """Return three masses in a row; the last one is the tip."""
    return rb.Matrices(M=MASS, C=damping, K=STIFFNESS, points={"tip": 2, "root": 0}, **options)


def generator(damping: Array) -> Array:
    """Return the first-order form of the three masses."""
    inverse = np.linalg.inv(MASS)
    return np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ STIFFNESS, -inverse @ damping]])


START = np.array([1e-3, -2e-3, 0.5e-3, 0.3, 0.0, -0.2])


@pytest.mark.parametrize("damping", DASHPOTS.values(), ids=DASHPOTS)
@pytest.mark.parametrize("method", [rb.EventDriven(), rb.TwoStep(dt_flight=1e-4)], ids=["exact", "two steps"])
def test_free_motion(damping: Array, method: Any) -> None:
    """The free motion with any symmetric damping matrix agrees with the matrix exponential."""
    if isinstance(method, rb.TwoStep) and damping.max() > 1e4:
        method = rb.TwoStep(dt_flight=1e-5)
    case = rb.Case(
        structure=structure(damping, displacement=START[:3], velocity=START[3:]),
        duration=0.5,
        method=method,
        output=rb.Output(times=np.linspace(0, 0.5, 51)),
    )
    run = rb.simulate(case)
    assert run.ok, run.message
    exact = np.array([expm(generator(damping) * t) @ START for t in case.output.times])
    result = run.motion.sel(point="tip")
    bound = 1e-13 if isinstance(method, rb.EventDriven) else 1e-8
    np.testing.assert_allclose(result.displacement, exact[:, 2], atol=bound * 2e-3)
    np.testing.assert_allclose(result.velocity, exact[:, 5], atol=bound * 2e-3 * 300)


@pytest.mark.parametrize("damping", DASHPOTS.values(), ids=DASHPOTS)
def test_free_motion_in_three_dimensions(damping: Array) -> None:
    """The 3-D engine moves a structure with any damping matrix as the matrix exponential does; the ledger closes."""
    untouched = rb.ParticleDamper(
        particles=rb.Particles(material="steel", radius="50 mm", count=1),
        cavity=rb.Box(size=("1 m",) * 3),
        packing=rb.Positions(positions=[(0.0, 0.0, 0.0)]),
        gravity=(0, 0, 0),
        point="tip",
        direction="z",
        contact=rb.Tsuji(restitution=0.6),
        wall="steel",
    )
    own = structure(damping, displacement=START[:3], velocity=START[3:])
    run = rb.simulate(rb.Case(structure=own, damper=untouched, duration=0.2, output=rb.Output(rate=500.0)))
    assert run.ok, run.message
    exact = np.array([expm(generator(damping) * t) @ START for t in run.motion.time.values])
    result = run.motion.sel(point="tip")
    np.testing.assert_allclose(result.displacement, exact[:, 2], atol=1e-11 * np.abs(exact[:, 2]).max())
    np.testing.assert_allclose(result.velocity, exact[:, 5], atol=1e-11 * np.abs(exact[:, 5]).max())
    first, last = exact[0], exact[-1]
    energies = [0.5 * s[3:] @ MASS @ s[3:] + 0.5 * s[:3] @ STIFFNESS @ s[:3] for s in (first, last)]
    assert float(run.energy.viscous_loss[-1]) == pytest.approx(energies[0] - energies[1], rel=1e-9)


def test_forced_motion() -> None:
    """The steady response to a harmonic force agrees with the inverse of the dynamic stiffness."""
    damping, frequency = DASHPOTS["between two"] + 0.001 * STIFFNESS, 14.0
    case = rb.Case(
        structure=structure(damping),
        load=rb.Harmonic(amplitude=3.0, frequency=frequency, point="root"),
        duration=8.0,
        output=rb.Output(times=7 + np.arange(64) / 64 / frequency),
    )
    z = rb.simulate(case).motion.displacement.sel(point="tip", time=slice(6.999, 7.9)).values[:64]
    t = np.asarray(case.output.times)[:64]
    omega = 2 * math.pi * frequency
    amplitude = 2 * np.mean(z * np.exp(-1j * omega * t))
    exact = -1j * np.linalg.solve(STIFFNESS - omega**2 * MASS + 1j * omega * damping, [3.0, 0.0, 0.0])[2]
    assert abs(amplitude / exact - 1) < 1e-9


def impacts_case(structure: Any, **options: Any) -> rb.Case:
    """Return a ball in a cavity at the tip of a vibrating structure."""
    damper = rb.ImpactDamper(
        ball=rb.Sphere(radius="12 mm", material="steel"), gap="0.4 mm", point="tip", contact=rb.Tsuji(restitution=0.6)
    )
    return rb.Case(structure=structure, damper=damper, duration=0.4, **options)


@pytest.mark.parametrize("damping", DASHPOTS.values(), ids=DASHPOTS)
def test_the_ledger_closes_with_impacts(damping: Array) -> None:
    """The energy ledger of a ball on a structure with coupled modes closes to rounding, unless its point is fixed."""
    run = rb.simulate(impacts_case(structure(damping, displacement=[1e-3, -2e-3, 0.0], velocity=10 * START[3:])))
    assert run.ok and (len(run.arrays.impacts) > 10) == (damping[2, 2] < 1e3)
    assert run.ledger.energy_residual < 1e-11


def test_weak_coupling_changes_little() -> None:
    """The algorithms for coupled and uncoupled modes agree up to the tenth impact."""
    damping = 0.002 * STIFFNESS
    off = np.zeros((3, 3))
    off[0, 2] = off[2, 0] = 2e-6
    cases = [
        impacts_case(structure(c, displacement=[1e-3, -2e-3, 0.0], velocity=10 * START[3:]))
        for c in (damping, damping + off)
    ]
    assert [case.modes.coupling is None for case in cases] == [True, False]
    runs = [rb.simulate(case) for case in cases]
    times = [run.impacts.time.values[:10] for run in runs]
    np.testing.assert_allclose(times[0], times[1], rtol=1e-5)


def test_both_engines_agree() -> None:
    """The 3-D engine with one ball in a box agrees with the 1-D engine on a structure with coupled modes."""
    own = structure(DASHPOTS["between two"], displacement=[1e-3, -2e-3, 0.0])
    duration = 0.05
    ball = rb.Particles(material="steel", radius="12 mm", count=1)
    box = rb.ParticleDamper(
        particles=ball,
        cavity=rb.Box(size=("30 mm", "30 mm", "24.8 mm")),
        packing=rb.Positions(positions=[(0.0, 0.0, 0.0)]),
        point="tip",
        direction="z",
        gravity=(0, 0, 0),
        contact=rb.Tsuji(restitution=0.6),
        wall="steel",
    )
    output = rb.Output(rate=2000.0)
    dem = rb.simulate(
        rb.Case(structure=own, damper=box, duration=duration, method=rb.Dem(fraction=0.005), output=output)
    )
    exact = rb.simulate(
        rb.Case(
            structure=own,
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="12 mm", material="steel"),
                gap="0.4 mm",
                point="tip",
                contact=rb.Tsuji(restitution=0.6),
            ),
            duration=duration,
            output=rb.Output(times=dem.motion.time.values),
        )
    )
    assert dem.ok and exact.ok and len(exact.arrays.impacts) >= 3
    z = exact.motion.displacement.sel(point="tip").values
    np.testing.assert_allclose(dem.motion.displacement.sel(point="tip").values, z, atol=2e-3 * np.abs(z).max())
    assert dem.ledger.energy_residual < 1e-3


def two_masses(tuned: rb.TunedMass, mass: float, stiffness: float, damping: float, **options: Any) -> rb.Matrices:
    """Return the structure and its tuned mass as one system of matrices."""
    rate = 2 * math.pi * tuned.frequency
    k, c = tuned.mass * rate**2, 2 * tuned.damping_ratio * tuned.mass * rate
    return rb.Matrices(
        M=np.diag([mass, tuned.mass]),
        C=[[damping + c, -c], [-c, c]],
        K=[[stiffness + k, -k], [-k, k]],
        points={"tip": 0, "tuned mass": 1},
        **options,
    )


def test_a_tuned_mass_and_a_damper() -> None:
    """SDOF, tuned mass and ball move like the same two masses given by matrices, also with a base motion."""
    tuned = rb.TunedMass(mass="0.4 kg", frequency="9 Hz", damping_ratio=0.1)
    base = rb.Harmonic(amplitude="3 m/s^2", frequency="10 Hz")
    own = rb.Modal(frequencies=[10.0], damping_ratios=[0.01], shapes={"tip": [0.25**0.5]}, participation=[2.0])
    stiffness = 4.0 * (20 * math.pi) ** 2
    whole = two_masses(tuned, 4.0, stiffness, 2 * 0.01 * math.sqrt(stiffness * 4.0))
    runs = [
        rb.simulate(impacts_case(own, tuned_mass=tuned, base=base)),
        rb.simulate(impacts_case(whole, base=base)),
    ]
    first, second = (run.impacts.time.values[:10] for run in runs)
    assert first.size == 10
    np.testing.assert_allclose(first, second, rtol=1e-9)
    assert runs[0].ledger.energy_residual < 1e-11


def peak(structure: rb.SDOF, tuned: rb.TunedMass, *, base: bool) -> float:
    """Return the largest displacement of the structure over frequency, for a unit of static displacement."""
    m, k = structure.mass, structure.stiffness
    rate = 2 * math.pi * tuned.frequency
    kt, ct = tuned.mass * rate**2, 2 * tuned.damping_ratio * tuned.mass * rate
    mass = np.diag([m, tuned.mass])
    stiffness = np.array([[k + kt, -kt], [-kt, kt]])
    damping = np.array([[ct, -ct], [-ct, ct]])
    force = np.array([m, tuned.mass]) / m if base else np.array([1.0, 0.0])
    omega = math.sqrt(k / m) * np.linspace(0.6, 1.3, 6001)[:, None, None]
    motion = np.linalg.solve(stiffness - omega**2 * mass + 1j * omega * damping, (k * force)[None, :, None])
    return float(np.abs(motion[:, 0, 0]).max())


@pytest.mark.parametrize("mass", [0.2, 1.0, 4.0])
def test_den_hartog(mass: float) -> None:
    """Den Hartog's peak is sqrt(1 + 2 / mu), and no other frequency lowers it by more than one per mille."""
    own = rb.SDOF(mass=20.0, stiffness=80e3)
    tuned = rb.TunedMass.den_hartog(own, mass=mass)
    optimum = peak(own, tuned, base=False)
    assert optimum == pytest.approx(math.sqrt(1 + 2 * 20 / mass), rel=5e-3)
    best = minimize_scalar(
        lambda f: peak(own, tuned.model_copy(update={"frequency": f}), base=False),
        bounds=(0.97 * tuned.frequency, 1.03 * tuned.frequency),
        method="bounded",
    )
    assert optimum < 1.003 * best.fun


@pytest.mark.parametrize("mass", [0.2, 1.0, 4.0])
def test_warburton(mass: float) -> None:
    """With a base motion Warburton's frequency minimises the largest displacement; Den Hartog's does not."""
    own = rb.SDOF(mass=20.0, stiffness=80e3)
    tuned = rb.TunedMass.warburton(own, mass=mass)
    optimum = peak(own, tuned, base=True)
    best = minimize_scalar(
        lambda f: peak(own, tuned.model_copy(update={"frequency": f}), base=True),
        bounds=(0.97 * tuned.frequency, 1.03 * tuned.frequency),
        method="bounded",
    )
    assert optimum < 1.003 * best.fun
    assert optimum < peak(own, rb.TunedMass.den_hartog(own, mass=mass), base=True)


def test_the_simulated_response_is_that_of_the_optimum() -> None:
    """The simulated steady response at the frequency of the structure is that of the two masses."""
    own = rb.SDOF(mass=20.0, stiffness=80e3)
    tuned = rb.TunedMass.den_hartog(own, mass=1.0)
    frequency = math.sqrt(80e3 / 20) / (2 * math.pi)
    case = rb.Case(
        structure=own,
        tuned_mass=tuned,
        load=rb.Harmonic(amplitude=80.0, frequency=frequency),
        duration=20.0,
        output=rb.Output(times=19 + np.arange(64) / 64 / frequency),
    )
    z = rb.simulate(case).motion.displacement.sel(point="mass").values
    rate = 2 * math.pi * tuned.frequency
    stiffness, omega = rate**2, 2 * math.pi * frequency
    complex_stiffness = stiffness + 2j * tuned.damping_ratio * rate * omega
    exact = 80.0 / abs(80e3 - 20 * omega**2 + complex_stiffness - complex_stiffness**2 / (complex_stiffness - omega**2))
    assert np.abs(z).max() == pytest.approx(exact, rel=2e-3)
    assert exact / 1e-3 < math.sqrt(1 + 2 * 20)


def test_a_tuned_mass_in_three_dimensions() -> None:
    """A tuned mass moves along its direction like the same mass on the structure in 1-D."""
    own = rb.Modal(
        frequencies=[10.0, 10.0],
        damping_ratios=[0.0, 0.0],
        shapes={"tip": [[0.5, 0.0, 0.0], [0.0, 0.0, 0.5]]},
        participation=[[2.0, 0.0, 0.0], [0.0, 0.0, 2.0]],
        velocity=[0.1, 0.1],
    )
    tuned = rb.TunedMass(mass=0.4, frequency=9.0, damping_ratio=0.1, point="tip", direction="z")
    particles = rb.ParticleDamper(
        particles=rb.Particles(material="steel", radius="1 mm", count=1),
        cavity=rb.Box(size=("1 m",) * 3),
        packing=rb.Positions(positions=[(0.0, 0.0, 0.0)]),
        gravity=(0, 0, 0),
        point="tip",
        contact=rb.Tsuji(restitution=0.6),
        wall="steel",
    )
    run = rb.simulate(
        rb.Case(structure=own, tuned_mass=tuned, damper=particles, duration=0.3, output=rb.Output(rate=200.0))
    )
    line = rb.Modal(frequencies=[10.0], damping_ratios=[0.0], shapes={"tip": [0.5]}, velocity=[0.1])
    alone = rb.simulate(
        rb.Case(
            structure=line,
            tuned_mass=tuned.model_copy(update={"direction": None}),
            duration=0.3,
            output=rb.Output(times=run.motion.time.values),
        )
    )
    moved = run.motion.displacement
    np.testing.assert_allclose(moved.sel(point="tip z"), alone.motion.displacement.sel(point="tip"), atol=1e-13)
    np.testing.assert_allclose(
        moved.sel(point="tuned mass"), alone.motion.displacement.sel(point="tuned mass"), atol=1e-13
    )
    free = 0.5 * 0.1 / (20 * math.pi) * np.sin(20 * math.pi * run.motion.time)
    np.testing.assert_allclose(moved.sel(point="tip x"), free, atol=1e-13)


def test_studies_vary_a_tuned_mass() -> None:
    """A sweep over mass and frequency agrees with single runs."""
    own = rb.SDOF(mass="4 kg", stiffness="16 kN/m", damping_ratio=0.01, velocity="0.1 m/s")
    case = rb.Case(
        structure=own,
        tuned_mass=rb.TunedMass(mass="0.2 kg", frequency="9 Hz", damping_ratio=0.1),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="12 mm", material="steel"), gap="0.4 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        duration=0.5,
        output=rb.Output(rate=1000.0),
    )
    axes: dict[str, Any] = {"tuned_mass.frequency": [8.0, 9.5, 11.0], "tuned_mass.mass": [0.1, 0.3, 0.5]}
    result = rb.sweep(case, axes, ["rms", "viscous_share"])
    for i, frequency in enumerate(axes["tuned_mass.frequency"]):
        for j, mass in enumerate(axes["tuned_mass.mass"]):
            tuned = rb.TunedMass(mass=mass, frequency=frequency, damping_ratio=0.1)
            run = rb.simulate(case.model_copy(update={"tuned_masses": (tuned,)}))
            share = float(run.energy.share.sel(channel="viscous"))
            assert float(result.viscous_share[i, j]) == pytest.approx(share, rel=1e-9)
            z = run.motion.displacement.sel(point="mass").values
            rms = math.sqrt(np.trapezoid(z**2) / (z.size - 1))
            assert float(result.rms[i, j]) == pytest.approx(rms, rel=1e-4)  # sampled at other times
    only = rb.sweep(case, {"tuned_mass.frequency": [8.0, 9.5]}, ["rms"])
    np.testing.assert_allclose(only.rms[0], rb.sweep(case, {"tuned_mass.frequency": [8.0]}, ["rms"]).rms[0])


def test_case_files_hold_tuned_masses() -> None:
    """A case survives a round trip through TOML; the path of one of two tuned masses selects it."""
    case = rb.Case(
        structure=rb.SDOF(mass=4, stiffness=16e3),
        tuned_masses=[
            rb.TunedMass(mass=0.2, frequency=9, damping_ratio=0.1),
            rb.TunedMass(mass=0.1, frequency=11, name="upper"),
        ],
        duration=0.1,
    )
    assert rb.Case.from_toml(case.to_toml()) == case
    assert list(rb.simulate(case).motion.point.values) == ["mass", "tuned mass 1", "upper"]


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: rb.TunedMass(mass=-1, frequency=9), "mass"),
        (lambda: rb.TunedMass.den_hartog(rb.SDOF(mass=1, stiffness=0), mass=0.1), "mode"),
        (lambda: rb.TunedMass.den_hartog(rb.SDOF(mass=1, stiffness=1), mass=0.1, mode=2), "mode"),
        (lambda: rb.TunedMass.den_hartog(rb.SDOF(mass=1, stiffness=1), mass=0.1, point="tip"), "tip"),
        (lambda: rb.TunedMass.warburton(rb.SDOF(mass=1, stiffness=1), mass=3.0), "mass"),
        (
            lambda: rb.Case(structure=rb.Fixed(), tuned_mass=rb.TunedMass(mass=1, frequency=9), duration=1),
            "tuned_mass",
        ),
        (
            lambda: rb.Case(
                structure=rb.SDOF(mass=1, stiffness=1),
                tuned_mass=rb.TunedMass(mass=1, frequency=9, point="tip"),
                duration=1,
            ),
            "point",
        ),
        (
            lambda: rb.Case(
                structure=rb.SDOF(mass=1, stiffness=1),
                tuned_mass=rb.TunedMass(mass=1, frequency=9, name="mass"),
                duration=1,
            ),
            "name",
        ),
        (
            lambda: rb.Case(
                structure=rb.SDOF(mass=1, stiffness=1), damper=rb.TunedMass(mass=1, frequency=9), duration=1
            ),
            "tuned_mass",
        ),
        (lambda: structure(np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), "semidefinite"),
    ],
)
def test_bad_input(make: Any, word: str) -> None:
    """The message names the field."""
    with pytest.raises(rb.CaseError, match=word):
        make()
