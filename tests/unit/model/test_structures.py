"""Beams, plates, shear buildings and the ways to give damping, against closed forms and independent finite elements."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import eigh

import rattlebox as rb
from rattlebox.model.beams import wave_numbers
from rattlebox.model.modes import ModalModel
from rattlebox.model.plausibility import plausibility_notes

ENDS = ("clamped-free", "clamped-clamped", "clamped-pinned", "pinned-pinned", "pinned-free", "free-free")
WITH_TIP = [(ends, mu) for ends in ENDS for mu in (0.0, 1e-3, 0.7, 40.0) if mu == 0 or ends.endswith("free")]


def finite_elements(
    ends: str, stiffness: float, per_length: float, length: float, tip: float, n: int
) -> tuple[Any, ...]:
    """Squared frequencies, deflections of the nodes and inertia of cubic beam elements."""
    h = length / n
    k = stiffness / h**3 * np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                                     [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])  # fmt: skip
    m = per_length * h / 420 * np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                                         [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]])  # fmt: skip
    K, M = np.zeros((2 * n + 2,) * 2), np.zeros((2 * n + 2,) * 2)
    for e in range(n):
        K[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += k
        M[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += m
    M[2 * n, 2 * n] += tip
    first, second = ends.split("-")
    held = {"clamped": 2, "pinned": 1, "free": 0}
    gone = [*range(held[first]), *(2 * n + d for d in range(held[second]))]
    free = np.setdiff1d(np.arange(2 * n + 2), gone)
    values, vectors = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)])
    whole = np.zeros((2 * n + 2, values.size))
    whole[free] = vectors
    base = np.zeros(2 * n + 2)
    base[::2] = 1.0
    return values, whole[::2], whole.T @ M @ base


@pytest.mark.parametrize(("ends", "mu"), WITH_TIP)
def test_beams_are_those_of_finite_elements(ends: str, mu: float) -> None:
    """Frequencies, mode shapes and participation agree with 60 cubic elements, whose frequencies are upper bounds."""
    stiffness, per_length, length, n = 3.0, 2.0, 0.8, 60
    tip = mu * per_length * length
    beam = rb.Beam(
        length=length,
        ends=ends,
        bending_stiffness=stiffness,
        mass_per_length=per_length,
        tip_mass=tip,
        mode_count=6,
        points={f"at {k}": length * k / 12 for k in range(13)},
    )
    modes = beam.modes()
    squared, nodes, inertia = finite_elements(ends, stiffness, per_length, length, tip, n)
    rigid = int(np.sum(modes.stiffness == 0))
    assert rigid == {"pinned-free": 1, "free-free": 2}.get(ends, 0)
    beta = (modes.stiffness[rigid:] * per_length / stiffness) ** 0.25
    error = (beta * length / n) ** 4 / 720  # of cubic elements, which are too stiff
    np.testing.assert_allclose(squared[rigid:6] / modes.stiffness[rigid:] - 1, error, rtol=0.03, atol=2e-7)
    shapes = np.array([modes.shapes[f"at {k}"] for k in range(13)])
    sign = np.sign(np.sum(shapes * nodes[::5, :6], axis=0))
    np.testing.assert_allclose(shapes[:, rigid:], (sign * nodes[::5, :6])[:, rigid:], atol=2e-4 / math.sqrt(per_length))
    assert modes.participation is not None
    np.testing.assert_allclose(modes.participation[rigid:], (sign * inertia[:6])[rigid:], atol=1e-4)
    if rigid:  # which of several rigid modes is a choice; their sum over modes is not
        np.testing.assert_allclose(shapes[:, :rigid] @ shapes[:, :rigid].T, nodes[::5, :rigid] @ nodes[::5, :rigid].T,
                                   atol=1e-6)  # fmt: skip
        np.testing.assert_allclose(np.sum(modes.participation[:rigid] ** 2), np.sum(inertia[:rigid] ** 2), rtol=1e-6)


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        ("clamped-free", [1.87510406871196, 4.69409113297417, 7.85475743823761]),
        ("clamped-clamped", [4.73004074486270, 7.85320462409584, 10.9956078380017]),
        ("free-free", [4.73004074486270, 7.85320462409584, 10.9956078380017]),
        ("clamped-pinned", [3.92660231204792, 7.06858274562873, 10.2101761228130]),
        ("pinned-free", [3.92660231204792, 7.06858274562873, 10.2101761228130]),
        ("pinned-pinned", [math.pi, 2 * math.pi, 3 * math.pi]),
    ],
)
def test_wave_numbers_of_handbooks(ends: Any, expected: list[float]) -> None:
    """Beta L of the first modes are those of tables, and those of high modes are the asymptotic ones."""
    result = wave_numbers(ends, 100)
    np.testing.assert_allclose(result[:3], expected, rtol=1e-13)
    phase = {"clamped-free": -0.5, "clamped-clamped": 0.5, "free-free": 0.5, "pinned-pinned": 0.0}.get(ends, 0.25)
    np.testing.assert_allclose(result[20:], (np.arange(21, 101) + phase) * math.pi, rtol=1e-14)


def test_a_heavy_tip_mass_is_a_mass_on_a_spring() -> None:
    """With a tip mass of a million beams, the first frequency is that of 3 E I / L^3 and the mass and 33/140 beams."""
    beam = rb.Beam(length=2.0, bending_stiffness=5.0, mass_per_length=0.1, tip_mass=2e5, mode_count=2)
    expected = math.sqrt(3 * 5.0 / 2.0**3 / (2e5 + 33 / 140 * 0.2)) / (2 * math.pi)
    assert beam.frequencies[0] == pytest.approx(expected, rel=1e-10)
    assert beam.modes().effective_mass("tip") == pytest.approx(2e5, rel=1e-5)


@pytest.mark.parametrize("ends", ENDS)
def test_modes_of_beams_are_orthonormal(ends: str) -> None:
    """Mass-normalised shapes at many points reproduce the unit matrix, also of high modes."""
    x, weight = np.polynomial.legendre.leggauss(120)
    places = {f"{k}": (1 + place) / 2 for k, place in enumerate(x)}
    beam = rb.Beam(length=1.0, ends=ends, bending_stiffness=1.0, mass_per_length=3.0, mode_count=40, points=places)
    modes = beam.modes()
    shapes = np.array([modes.shapes[name] for name in places])
    np.testing.assert_allclose(3.0 * (shapes.T * (weight / 2)) @ shapes, np.eye(40), atol=1e-11)


@pytest.mark.parametrize("ends", ["clamped-free", "clamped-clamped", "pinned-pinned"])
def test_effective_masses_of_a_beam_add_up(ends: str) -> None:
    """The effective masses of 52 modes miss the mass by that of the higher modes, which falls as 1 / n."""
    beam = rb.Beam(length=1.0, ends=ends, bending_stiffness=1.0, mass_per_length=1.0, mode_count=52)
    missing = 1.0 - np.cumsum(beam.modes().participation ** 2)
    assert 0 < missing[51] < 0.02
    assert missing[25] / missing[51] == pytest.approx(2, rel=0.02)


def test_effective_masses_of_a_cantilever() -> None:
    """The first four are 61.31, 18.83, 6.47 and 3.31 per cent of the mass."""
    modes = rb.Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0).modes()
    np.testing.assert_allclose(modes.participation**2, [0.6131, 0.1883, 0.0647, 0.0331], atol=5e-5)


def test_sections_of_beams() -> None:
    """Tubes, bars and rectangles have the stiffness and mass of the formulas."""
    steel = rb.materials()["steel"]
    tube = rb.Beam(length=1.0, material="steel", diameter="30 mm", inner_diameter="20 mm")
    assert tube.section == pytest.approx(
        (steel.young * math.pi / 64 * (0.03**4 - 0.02**4), steel.density * math.pi / 4 * (0.03**2 - 0.02**2))
    )
    plank = rb.Beam(length=1.0, material="steel", width="30 mm", height="5 mm")
    assert plank.section == pytest.approx((steel.young * 0.03 * 0.005**3 / 12, steel.density * 0.03 * 0.005))
    same = rb.Beam(
        length=1.0, bending_stiffness=f"{plank.section[0]} N m^2", mass_per_length=f"{plank.section[1]} kg/m"
    )
    np.testing.assert_allclose(same.frequencies, plank.frequencies, rtol=1e-14)


def test_stubby_beams_are_warned_of() -> None:
    """A run warns of shear and rotary inertia by the error of Timoshenko's beam, and not where it is small."""
    slender = {"length": "1 m", "ends": "pinned-pinned", "material": "steel", "width": "20 mm", "height": "20 mm"}
    assert not list(rb.Beam(**slender, mode_count=4).warnings())
    stubby = rb.Beam(**slender | {"height": "100 mm"}, mode_count=4)
    (message,) = stubby.warnings()
    case = rb.Case(structure=stubby, duration=1.0)
    assert any(message in note for note in plausibility_notes(case))
    # Timoshenko's pinned beam: exact frequencies of the first mode that is warned of
    steel, k = rb.materials()["steel"], 3 * math.pi
    kappa = 10 * (1 + steel.poisson) / (12 + 11 * steel.poisson)
    r2, ratio = 0.1**2 / 12, 2 * (1 + steel.poisson) / kappa
    a, b, c = (
        r2**2 * ratio * steel.density**2 / steel.young**2,
        -(1 + k**2 * r2 * (1 + ratio)) * steel.density / steel.young,
        k**4 * r2,
    )
    squared = (-b - math.sqrt(b * b - 4 * a * c)) / (2 * a)
    lower = 1 - math.sqrt(squared) / (2 * math.pi) / stubby.frequencies[2]
    assert lower == pytest.approx(0.13, abs=0.03)
    assert "mode 2" in message or "mode 3" in message


def test_plates_have_the_modes_of_kirchhoff() -> None:
    """Frequencies in order, mass-normalised shapes, and participation by quadrature."""
    plate = rb.Plate(
        length=1.2, width=0.5, bending_stiffness="800 N m", mass_per_area="6 kg/m^2", mode_count=60,
        points={"here": (0.33, 0.41)},
    )  # fmt: skip
    every = sorted(
        math.pi / 2 * (m**2 / 1.2**2 + n**2 / 0.5**2) * math.sqrt(800 / 6) for m in range(1, 99) for n in range(1, 99)
    )
    np.testing.assert_allclose(plate.frequencies, every[:60], rtol=1e-13)
    modes = plate.modes()
    for k in (0, 7, 59):
        m, n = plate.half_waves[k]
        mean = [
            quad(lambda s, c=c, edge=edge: math.sin(c * math.pi * s / edge), 0, edge)[0]
            for c, edge in ((m, 1.2), (n, 0.5))
        ]
        scale = 2 / math.sqrt(6 * 1.2 * 0.5)
        assert modes.participation[k] == pytest.approx(6 * scale * mean[0] * mean[1], abs=1e-12)
        here = scale * math.sin(m * math.pi * 0.33 / 1.2) * math.sin(n * math.pi * 0.41 / 0.5)
        assert modes.shapes["here"][k] == pytest.approx(here, rel=1e-12)
    # All modes with up to 11 half waves along each edge: each edge takes (8 / pi^2) (1 + 1/9 + ... + 1/121) of the mass.
    along = 8 / math.pi**2 * np.sum(1 / np.arange(1.0, 12.0, 2) ** 2)
    square = rb.Plate(length=1.0, width=1.0, bending_stiffness=1.0, mass_per_area=6.0, mode_count=120)
    low = np.max(square.half_waves, axis=1) <= 11
    assert low.sum() == pytest.approx(121, abs=25)
    assert np.sum(square.modes().participation[low] ** 2) == pytest.approx(6 * along**2, rel=2e-3)


@pytest.mark.parametrize("n", [1, 2, 5, 40])
def test_shear_buildings_of_equal_storeys(n: int) -> None:
    """Frequencies have the closed form, effective masses add up to the mass, and shapes to the inverse masses."""
    tower = rb.ShearBuilding(masses=["50 t"] * n, stiffnesses=["60 MN/m"] * n)
    j = np.arange(1, n + 1)
    exact = 2 * math.sqrt(60e6 / 50e3) * np.sin((2 * j - 1) * math.pi / (2 * (2 * n + 1))) / (2 * math.pi)
    np.testing.assert_allclose(tower.frequencies, exact, rtol=1e-11)
    modes = tower.modes()
    assert list(modes.shapes) == [f"storey {k}" for k in j]
    assert np.sum(modes.participation**2) == pytest.approx(n * 50e3, rel=1e-12)
    shapes = np.array(list(modes.shapes.values()))
    np.testing.assert_allclose(shapes @ shapes.T, np.eye(n) / 50e3, atol=1e-15)


def test_shear_buildings_are_those_of_their_matrices() -> None:
    """Unequal storeys with Rayleigh damping move as M, C and K do."""
    m, k = [3.0, 2.0, 1.0], [500.0, 300.0, 100.0]
    K = np.array([[800.0, -300, 0], [-300, 400, -100], [0, -100, 100]])
    rayleigh = (0.3, 2e-3)
    options: dict[str, Any] = {"duration": 1.0, "output": rb.Output(rate=200)}
    load = rb.HalfSine(amplitude=10.0, duration=0.1, point="storey 3")
    tower = rb.simulate(
        rb.Case(structure=rb.ShearBuilding(masses=m, stiffnesses=k, rayleigh=rayleigh), load=load, **options)
    )
    points = {f"storey {j + 1}": j for j in range(3)}
    for damping in ({"C": 0.3 * np.diag(m) + 2e-3 * K}, {"rayleigh": rayleigh}):
        same = rb.Matrices(M=np.diag(m), K=K, points=points, **damping)
        run = rb.simulate(rb.Case(structure=same, load=load, **options))
        np.testing.assert_allclose(run.arrays.displacement, tower.arrays.displacement, atol=1e-9)


def rates(modes: ModalModel) -> Any:
    """Decay rate over angular frequency of each mode."""
    return modes.decay / np.sqrt(modes.stiffness)


def test_damping_ratios_of_matrices() -> None:
    """Damping is one ratio for all modes, a list of ratios, or Rayleigh's two constants; two of these are refused."""
    given: dict[str, Any] = {"M": [[2, 0], [0, 1]], "K": [[3e4, -1e4], [-1e4, 1e4]], "points": {"tip": 1}}
    np.testing.assert_allclose(rates(rb.Matrices(**given, damping_ratio=0.02).modes()), 0.02, rtol=1e-14)
    np.testing.assert_allclose(
        rates(rb.Matrices(**given, damping_ratio=[0.02, "3 %"]).modes()), [0.02, 0.03], rtol=1e-14
    )
    modes = rb.Matrices(**given, rayleigh=(0.4, 1e-4)).modes()
    omega = np.sqrt(modes.stiffness)
    np.testing.assert_allclose(rates(modes), 0.4 / (2 * omega) + 1e-4 * omega / 2, rtol=1e-12)
    with pytest.raises(rb.CaseError, match="exclude each other"):
        rb.Matrices(**given, rayleigh=(0.4, 1e-4), damping_ratio=0.1)
    with pytest.raises(rb.CaseError, match="3 numbers, but 2 modes"):
        rb.Matrices(**given, damping_ratio=[0.1, 0.1, 0.1])


def test_an_oscillator_by_its_frequency() -> None:
    """Mass, frequency and damping ratio are the oscillator of mass, stiffness and damping."""
    one = rb.SDOF(mass="3 kg", frequency="180 Hz", damping_ratio="1 %").modes()
    omega = 2 * math.pi * 180
    other = rb.SDOF(mass="3 kg", stiffness=3 * omega**2, damping=2 * 0.01 * 3 * omega).modes()
    assert one.stiffness == pytest.approx(other.stiffness, rel=1e-14)
    assert one.decay == pytest.approx(other.decay, rel=1e-14)
    for wrong in ({}, {"stiffness": 1.0, "frequency": 1.0}):
        with pytest.raises(rb.CaseError, match="stiffness"):
            rb.SDOF(mass=1.0, **wrong)


STRUCTURES = {
    "beam": 'kind = "beam"\nlength = "0.3 m"\nmaterial = "steel"\ndiameter = "20 mm"\ntip_mass = "0.2 kg"\n'
    'damping_ratio = 0.01\npoints = { inside = "25 cm" }',
    "plate": 'kind = "plate"\nlength = "0.6 m"\nwidth = "0.4 m"\nthickness = "3 mm"\nmaterial = "aluminium"\n'
    'damping_ratio = [0.01, 0.02, 0.01, 0.01]\npoints = { inside = ["0.1 m", "12 cm"] }',
    "shear_building": 'kind = "shear_building"\nmasses = ["50 t", "40 t"]\nstiffnesses = ["60 MN/m", "40 MN/m"]\n'
    "rayleigh = [0.1, 0.002]",
    "sdof": 'kind = "sdof"\nmass = "3 kg"\nfrequency = "180 Hz"\ndamping_ratio = 0.01',
}
LAW = 'contact = { kind = "tsuji", restitution = 0.8 }\n'
POINTS = {"beam": "tip", "plate": "inside", "shear_building": "storey 2", "sdof": "mass"}


@pytest.mark.parametrize("kind", STRUCTURES)
def test_structures_in_case_files_and_both_engines(kind: str) -> None:
    """A case file reads back equal; one ball moves alike in the impact engine and in the 3-D engine."""
    head = f'duration = "20 ms"\n[structure]\n{STRUCTURES[kind]}\n'
    load = f'[load]\nkind = "half_sine"\namplitude = "500 N"\nduration = "1 ms"\npoint = "{POINTS[kind]}"\n'
    line = (
        f'[damper]\npoint = "{POINTS[kind]}"\nball = {{ diameter = "10 mm", material = "steel" }}\ngap = "0.1 mm"\n'
        + LAW
    )
    case = rb.Case.from_toml(head + load + line)
    assert rb.Case.from_toml(case.to_toml()) == case
    ball = rb.simulate(case)
    assert ball.ok and ball.energy_residual < 1e-9
    box = (
        f'[damper]\npoint = "{POINTS[kind]}"\ncavity = {{ kind = "box", size = ["10.2 mm", "11 mm", "11 mm"] }}\n'
        'particles = { material = "steel", diameter = "10 mm", count = 1 }\ndirection = "x"\n'
        + LAW
        + 'packing = { kind = "positions", positions = [[0, 0, 0]] }\n'
    )
    space = rb.simulate(rb.Case.from_toml(head + load + box))
    assert space.ok
    end = [run.arrays.displacement[-1] for run in (ball, space)]
    np.testing.assert_allclose(end[1], end[0], atol=0.02 * np.abs(ball.arrays.displacement).max())


def test_structures_in_sweeps() -> None:
    """Fields of built-in structures are axes of studies, those of an oscillator by its frequency as well."""
    beam = rb.Beam(length="0.3 m", material="steel", diameter="20 mm", damping_ratio=0.01)
    ball = rb.ImpactDamper(
        ball=rb.Sphere(diameter="10 mm", material="steel"), gap="0.1 mm", contact=rb.Tsuji(restitution=0.8), point="tip"
    )
    case = rb.Case(
        structure=beam, load=rb.HalfSine(amplitude="500 N", duration="1 ms", point="tip"), damper=ball, duration="10 ms"
    )
    axes = {"structure.length": ["0.2 m", "0.3 m"], "structure.tip_mass": ["0 g", "50 g"]}
    result = rb.sweep(case, axes, measure=["largest_approach_speed"], progress=False)
    alone = rb.simulate(case.replaced({"structure.length": "0.2 m", "structure.tip_mass": "50 g"}))
    speeds = result.largest_approach_speed
    assert speeds.dims == tuple(axes)
    assert speeds.values[0, 1] == pytest.approx(alone.arrays.impacts.approach_speed.max(), rel=1e-9)
    assert len(np.unique(speeds.values)) == 4
    oscillator = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1e4),
        load=rb.HalfSine(amplitude=10.0, duration=0.01),
        damper=rb.ImpactDamper(ball=ball.balls[0], gap="0.1 mm", contact=rb.Tsuji(restitution=0.8)),
        duration=0.1,
    )
    grid = {"structure.frequency": [10.0, 20.0], "structure.mass": [1.0, 2.0]}
    swept = rb.sweep(oscillator, grid, measure=["largest_approach_speed"], progress=False)
    one = rb.simulate(oscillator.replaced({"structure.frequency": 20.0, "structure.mass": 2.0}))
    assert swept.largest_approach_speed.values[1, 1] == pytest.approx(one.arrays.impacts.approach_speed.max(), rel=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rb.Beam(length=1.0), "material and a cross-section"),
        (lambda: rb.Beam(length=1.0, material="steel"), "diameter or height is needed"),
        (lambda: rb.Beam(length=1.0, material="steel", height=0.1), "needs a width"),
        (lambda: rb.Beam(length=1.0, diameter=0.1, bending_stiffness=1.0, mass_per_length=1.0), "needs a material"),
        (lambda: rb.Beam(length=1.0, material="steel", diameter=0.1, inner_diameter=0.2), "less than the diameter"),
        (lambda: rb.Beam(length=1.0, material="steel", diameter=0.1, points={"p": 1.2}), "outside the beam"),
        (
            lambda: rb.Beam(length=1.0, material="steel", diameter=0.1, ends="pinned-pinned", tip_mass=1.0),
            "no free second end",
        ),
        (lambda: rb.Beam(length=1.0, material="steel", diameter=0.1, ends="free-clamped"), "clamped-free"),
        (lambda: rb.Beam(length=1.0, material="steel", diameter=0.1, tip_mass="1e30 kg"), "times the mass of the beam"),
        (lambda: rb.Beam(length=1.0, bending_stiffness="3 N/m", mass_per_length=1.0), "bending stiffness"),
        (lambda: rb.Plate(length=1.0, width=1.0, thickness=0.01), "material and a thickness"),
        (lambda: rb.Plate(length=1.0, width=1.0, thickness=0.01, material="steel", points={"p": (2, 0)}), "outside"),
        (lambda: rb.Plate(length=1.0, width=1.0, material="steel", mass_per_area=2.0), "material and a thickness"),
        (lambda: rb.ShearBuilding(masses=[1.0], stiffnesses=[1.0, 2.0]), "2 numbers, but there are 1 number"),
        (lambda: rb.ShearBuilding(masses=[], stiffnesses=[]), "at least one storey"),
        (lambda: rb.Beam(length=1.0, material="steel", diameter=0.1, damping_ratio=[0.1]), "1 number, but 4 modes"),
    ],
)
def test_what_is_refused(make: Any, message: str) -> None:
    """Structures that do not fit together are refused with the reason."""
    with pytest.raises(rb.CaseError, match=message):
        make()
