"""Units, structures, signals, dampers and materials."""

from __future__ import annotations

import math
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
from pydantic import ValidationError

import rattlebox as rb
from rattlebox.model.base import Part, vocabulary
from rattlebox.model.errors import translate

BALL = rb.Sphere(radius="5 mm", material="steel")


@pytest.mark.parametrize(
    "mass",
    [
        20.0,
        20,
        "20 kg",
        "20000 g",
        " 2e1 kg ",
        (20, "kg"),
        (np.float64(20), "kg"),
        np.float64(20),
        pint.UnitRegistry()("20 kg"),
    ],
)
def test_ways_to_write_a_quantity(mass: object) -> None:
    """Numbers, text, pairs and pint quantities of the same mass are equal."""
    assert rb.SDOF(mass=mass, stiffness=0.0).mass == 20.0


def kinds_of(part: type[Part]) -> set[type[Part]]:
    """Return the parts that a case file may have."""
    own = {part} if part.__module__.startswith("rattlebox.") and "kind" not in required(part) else set()
    return own.union(*map(kinds_of, part.__subclasses__()))


def required(part: type[Part]) -> list[str]:
    """Return the names of fields without a default."""
    return [name for name, field in part.model_fields.items() if field.is_required()]


NEEDED = [(part, name) for part in sorted({rb.Case, *kinds_of(Part)}, key=str) for name in required(part)]


@pytest.mark.parametrize(("part", "name"), NEEDED)
def test_the_message_for_a_missing_field_has_a_valid_example(part: type[Part], name: str) -> None:
    """The advice for a missing field is TOML with a valid value of that field."""
    finding = {"type": "missing", "loc": (name,), "input": {}}
    error = ValidationError.from_exception_data(part.__name__, [finding])
    *_, advice = str(translate(error, part.__name__, vocabulary())).partition("try: ")
    given = tomllib.loads(advice.replace(", ...", ""))
    assert given.keys() == {name}
    if "..." in advice:
        assert given[name]["kind"] in vocabulary()[name]
        return
    wrong: list[Any] = []
    try:
        part.model_validate(given)
    except ValidationError as refused:
        wrong += refused.errors()
    assert [result for result in wrong if result["loc"][:1] == (name,)] == []


def test_units_that_pint_converts() -> None:
    """Inches, pounds of force and revolutions per minute are converted."""
    assert rb.Sphere(diameter="1 inch", material="steel").radius == pytest.approx(0.0127, rel=1e-14)
    assert rb.HalfSine(amplitude="1 lbf", duration=1.0).amplitude == pytest.approx(4.4482216152605, rel=1e-14)
    assert rb.Harmonic(amplitude=1.0, frequency="120 rpm").frequency == pytest.approx(2.0, rel=1e-14)
    assert rb.Harmonic(amplitude=1.0, frequency="2 rad/s").frequency == pytest.approx(1 / math.pi, rel=1e-14)


@pytest.mark.parametrize(
    ("part", "name"),
    [
        (lambda value: rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=value), "damping_ratio"),
        (lambda value: rb.Mindlin(coefficient=value), "coefficient"),
        (lambda value: rb.Constant(e=value), "e"),
        (lambda value: rb.Material(density=1e3, young=1e9, poisson=value), "poisson"),
        (lambda value: rb.Particles(material="steel", radius=0.1, count=value), "count"),
        (lambda value: rb.Particles(material="steel", radius=0.1, fill_ratio=value), "fill_ratio"),
        (lambda value: rb.EventDriven(max_events=value), "max_events"),
    ],
)
@pytest.mark.parametrize("value", [True, np.False_])
def test_true_and_false_are_refused_as_numbers(part: Any, name: str, value: Any) -> None:
    """True and False are not accepted as 1 and 0 in fields of numbers."""
    with pytest.raises(rb.CaseError, match=f": {name} = .*\n  a number"):
        part(value)


def test_percentages_are_refused_as_angles() -> None:
    """A percentage is refused as an angle; angles with units and plain numbers are accepted."""
    registry = pint.UnitRegistry()
    for phase in ("50 %", registry.Quantity(50, "percent"), "3 ppm"):
        with pytest.raises(rb.CaseError, match=r"an angle .* is needed, not a ratio"):
            rb.Harmonic(amplitude=1.0, frequency=1.0, phase=phase)
    for phase in ("0.25 turn", registry.Quantity(math.pi / 2), registry.Quantity(90, "deg")):
        assert rb.Harmonic(amplitude=1.0, frequency=1.0, phase=phase).phase == pytest.approx(math.pi / 2, rel=1e-15)


def test_percentages_of_plain_numbers() -> None:
    """A plain number may be given in percent, with the same bits as the fraction."""
    assert rb.Particles(material="steel", radius=0.001, fill_ratio="36%").fill_ratio == 0.36
    assert rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio="1 %").damping_ratio == 0.01
    assert rb.Mindlin("30 %").coefficient == 0.3
    assert rb.Tsuji(restitution="75 %").restitution == rb.Tsuji(restitution=0.75).restitution
    box = {"particles": rb.Particles(material="steel", radius=0.001, count=1), "cavity": rb.Box(size=(0.1, 0.1, 0.1))}
    damper = rb.ParticleDamper(**box, contact=rb.Tsuji(restitution=1), friction="30 %", rolling="1 %")
    assert (damper.friction, damper.rolling) == (rb.Mindlin(0.3), rb.Rolling(0.01))
    with pytest.raises(rb.CaseError, match="restitution = '120 %'"):
        rb.Tsuji(restitution="120 %")


def test_none_is_refused_with_its_field() -> None:
    """None in a field of a number is refused with the name of the field."""
    for part in (lambda: rb.Mindlin(None), lambda: rb.TwoStep(dt_flight=None)):
        with pytest.raises(rb.CaseError, match=r": (coefficient|dt_flight) = None\n"):
            part()


def test_import_loads_no_heavy_libraries() -> None:
    """Importing rattlebox and building a case with common units loads none of the heavy libraries."""
    heavy = [
        "pint",
        "xarray",
        "matplotlib",
        "scipy",
        "h5netcdf",
        "h5py",
        "zarr",
        "distributed",
        "dask",
        "optuna",
        "SALib",
    ]
    heavy += ["pandas", "tomli_w", "typer", "rich", "jinja2", "cmcrameri"]
    program = (
        "import sys, rattlebox as rb; rb.SDOF(mass='20 kg', stiffness='80 kN/m');"
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_modes_of_one_degree_of_freedom() -> None:
    """One degree of freedom has one mode with its stiffness, decay, mass and initial state."""
    modes = rb.SDOF(mass=4.0, stiffness=36.0, damping=2.0, displacement=0.5, velocity=-1.0).modes()
    assert modes.stiffness == pytest.approx([9.0])
    assert modes.decay == pytest.approx([0.25])
    assert modes.effective_mass("mass") == pytest.approx(4.0)
    assert modes.participation == pytest.approx([2.0])
    assert (modes.q0 * modes.shape(None), modes.p0 * modes.shape(None)) == (pytest.approx([0.5]), pytest.approx([-1.0]))


def test_damping_ratio_and_coefficient_agree() -> None:
    """A damping ratio zeta and the coefficient 2 zeta sqrt(K M) have the same decay."""
    ratio = rb.SDOF(mass=4.0, stiffness=36.0, damping_ratio=0.1).modes()
    coefficient = rb.SDOF(mass=4.0, stiffness=36.0, damping=2.4).modes()
    assert ratio.decay == pytest.approx(coefficient.decay, rel=1e-14)


def test_matrices_reduce_to_modes() -> None:
    """A free chain of three masses with Rayleigh damping has exact frequencies, decay and inertia."""
    K = 100.0 * np.array([[1, -1, 0], [-1, 2, -1], [0, -1, 1]])
    M = 2.0 * np.eye(3)
    modes = rb.Matrices(M=M, C=0.1 * M + 0.002 * K, K=K, points={"end": 2, "mean": [1 / 3] * 3}).modes()
    np.testing.assert_allclose(modes.stiffness, [0.0, 50.0, 150.0], atol=1e-12)
    np.testing.assert_allclose(modes.decay, 0.05 + 0.001 * modes.stiffness, rtol=1e-12)
    assert modes.effective_mass("end") == pytest.approx(2.0)
    assert modes.participation is not None
    assert np.sum(modes.participation**2) == pytest.approx(6.0)
    np.testing.assert_allclose(np.abs(modes.shape("mean")), [1 / math.sqrt(6), 0, 0], atol=1e-12)


def test_damping_of_a_repeated_frequency() -> None:
    """Damping that couples only modes of equal frequency is treated as proportional."""
    modes = rb.Matrices(
        M=np.eye(2), C=[[0.3, 0.1], [0.1, 0.3]], K=4.0 * np.eye(2), points={"first": 0, "second": 1}
    ).modes()
    np.testing.assert_allclose(np.sort(modes.decay), [0.1, 0.2], rtol=1e-12)


def test_start_of_matrices() -> None:
    """The modes reproduce the initial displacements and velocities of the degrees of freedom."""
    modes = rb.Matrices(
        M=np.diag([1.0, 3.0]),
        C=np.zeros((2, 2)),
        K=[[2.0, -1.0], [-1.0, 1.0]],
        points={"a": 0, "b": 1},
        displacement=[0.1, -0.2],
        velocity=[3.0, 4.0],
    ).modes()
    assert [modes.shape(p) @ modes.q0 for p in "ab"] == pytest.approx([0.1, -0.2])
    assert [modes.shape(p) @ modes.p0 for p in "ab"] == pytest.approx([3.0, 4.0])


def test_motion_of_a_shaker_becomes_acceleration() -> None:
    """The acceleration of a harmonic displacement is -omega^2 times the displacement."""
    motion = rb.Harmonic(amplitude="2 mm", frequency="10 Hz", phase=0.3)
    case = rb.Case(structure=rb.Shaker(motion=motion), duration=1.0)
    (acceleration,) = case.base_acceleration()
    t = np.linspace(0.0, 0.5, 7)
    assert acceleration.unit == "m/s^2"
    np.testing.assert_allclose(acceleration.evaluate(t), -((20 * math.pi) ** 2) * motion.evaluate(t), rtol=1e-13)


def test_values_of_signals() -> None:
    """Pulse, harmonic and record have their values within their time span and zero outside."""
    t = np.array([-0.5, 0.0, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(rb.HalfSine(amplitude=3.0, duration=1.0).evaluate(t), [0, 0, 3, 0, 0], atol=1e-15)
    np.testing.assert_allclose(
        rb.Harmonic(amplitude=2.0, frequency=0.25, phase="90 deg", stop=2.0).evaluate(t),
        [0, 2, math.sqrt(2), 0, 0],
        atol=1e-15,
    )
    np.testing.assert_allclose(
        rb.Record(times=[0, 1, 2], values=[0, 1, 5], scale=2.0).evaluate(t), [0, 0, 1, 2, 10], atol=1e-15
    )


def test_random_record_has_its_density() -> None:
    """The mean square of a random record is the integral of its density; the seed fixes the record."""
    make = [rb.Random([(10.0, 2e-3), (100.0, 2e-3)], 100.0, 500.0, seed=s) for s in (1, 1, 2)]
    values = np.array(make[0].values)
    assert make[0] == make[1]
    assert (make[0].values != make[2].values).any()
    assert make[0].times[-1] == 100.0
    assert np.mean(values**2) == pytest.approx(2e-3 * 90.0, rel=0.05)


@pytest.mark.parametrize(("duration", "rate"), [(0.333, 1000), (0.3, 1000), (0.07, 1000), (0.29, 1000), (1 / 3, 3000)])
def test_random_record_covers_its_duration(duration: float, rate: float) -> None:
    """A random record ends at its duration or at the first sample after it, for any rounding of the step."""
    record = rb.Random([(10.0, 1.0), (50.0, 1.0)], duration, rate)
    assert len(record.times) == 1 + math.ceil(round(duration * rate, 9))
    rb.Case(structure=rb.SDOF(mass=1.0, stiffness=1.0), load=record, duration=duration)


def test_random_vibration_takes_units() -> None:
    """Random accepts quantities with units and numbers in SI."""
    psd = [(10.0, 1.0), (50.0, 1.0)]
    assert rb.Random(psd, "500 ms", "1 kHz") == rb.Random(psd, 0.5, 1000.0)


BOX = rb.ParticleDamper(
    particles=rb.Particles(count=1, diameter="2 mm", material="steel"),
    cavity=rb.Box(size=["20 mm", "20 mm", "20 mm"]),
    contact=rb.Tsuji(restitution=0.5),
)


@pytest.mark.parametrize("late", [0.0, 1e-17])
@pytest.mark.parametrize(
    "parts",
    [
        {"method": rb.EventDriven()},
        {"method": rb.TwoStep()},
        {"method": rb.Newton()},
        {"damper": BOX.model_copy(update={"softening": 100.0})},  # longer steps
    ],
)
def test_a_record_may_miss_the_ends_by_rounding(parts: dict[str, Any], late: float) -> None:
    """A record whose accumulated times miss the start or the end of the run by rounding is accepted."""
    times = np.cumsum([late] + [0.1] * 10)
    assert times[-1] < 1.0
    first, second = (
        rb.simulate(
            rb.Case(
                structure=rb.SDOF(mass=1.0, stiffness=100.0),
                load=rb.Record(times=knots, values=np.ones(11)),
                duration=1.0,
                output=rb.Output(rate=100),
                **parts,
            )
        )
        for knots in (times, np.linspace(0.0, 1.0, 11))
    )
    for name in ("displacement", "velocity", "load"):
        one, other = (getattr(run.arrays, name) for run in (first, second))
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([0.0, 0.5], r"covers 0 s to 0.5 s, the run 0 to 1 s\n  try: duration = \"0.5 s\", or a longer record"),
        ([0.5, 2.0], r"covers 0.5 s to 2 s, the run 0 to 1 s\n  try: time_zero = \"first\""),
        ([0.0, 1 - 1e-8], r"covers 0 s to 0.99999999 s, the run 0 to 1 s"),
    ],
)
def test_a_record_that_misses_a_part_of_the_run(times: list[float], message: str) -> None:
    """A record that does not cover the run is refused with its span and advice."""
    with pytest.raises(rb.CaseError, match=message):
        rb.Case(
            structure=rb.SDOF(mass=1.0, stiffness=1.0), load=rb.Record(times=times, values=[0.0, 1.0]), duration=1.0
        )


@pytest.mark.parametrize("name", ["push.csv", "push.npy", "push.mat"])
def test_record_files(tmp_path: Path, name: str) -> None:
    """Records are read from CSV, NPY and MAT files."""
    from scipy.io import savemat

    table = np.array([[0.0, 1.0], [0.5, 1 / 3], [2.0, -4.0]])
    path = tmp_path / name
    if path.suffix == ".csv":
        path.write_text("time;force\n" + "".join(f"{a!r};{b!r}\n" for a, b in table.tolist()), encoding="utf-8")
    elif path.suffix == ".npy":
        np.save(path, table)
    else:
        savemat(path, {"time": table[:, 0], "value": table[:, 1]})
    record = rb.Record.from_file(path, unit="N", scale=2.0)
    np.testing.assert_array_equal([record.times, record.values], table.T)
    np.testing.assert_allclose(record.evaluate([0.5]), 2 / 3, rtol=1e-15)


def test_row_of_balls() -> None:
    """The balls of a packed row touch and are centred; clearance and masses are exact."""
    balls = [rb.Sphere(radius=r, material="steel") for r in (1e-3, 2e-3, 3e-3)]
    damper = rb.ImpactDamper(balls=balls, cavity_length="14 mm", start=[-1, 0, 0.5], contact=rb.Tsuji(restitution=0.9))
    np.testing.assert_allclose(damper.centres, [-5e-3, -2e-3, 3e-3], rtol=1e-12)
    assert damper.clearance == pytest.approx(2e-3, rel=1e-12)
    np.testing.assert_allclose(damper.positions0, [-1e-3, 0.0, 5e-4], rtol=1e-11)
    np.testing.assert_allclose(damper.masses, 7850 * 4 / 3 * math.pi * np.array([1, 8, 27]) * 1e-9, rtol=1e-12)


def test_pairs_of_a_row() -> None:
    """A row of n balls has n + 1 contacts in order, each with its effective mass, radius and modulus."""
    case = rb.Case(
        structure=rb.SDOF(mass=2.0, stiffness=1.0),
        damper=rb.ImpactDamper(
            balls=[BALL, rb.Sphere(radius="10 mm", material="brass", mass=1.0)],
            gap="1 mm",
            wall="rigid",
            contact=rb.Tsuji(restitution=0.9),
        ),
        duration=1.0,
    )
    left, middle, right = rb.contact_pairs(case, 0)
    small = case.dampers[0].masses[0]
    assert (left.is_wall, middle.is_wall, right.is_wall) == (True, False, True)
    assert right.mass == pytest.approx(2 / 3)
    assert middle.mass == pytest.approx(small / (1 + small))
    assert middle.radius == pytest.approx(1 / 300)
    assert left.modulus == pytest.approx(200e9 / 0.91)


def test_pairs_that_do_not_exist_are_refused() -> None:
    """Cases without the impact damper are refused; the advice for particles returns their pairs. Only rows were tested."""
    structure = rb.SDOF(mass=2.0, stiffness=1.0)
    ball = rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.9))
    one = rb.Case(structure=structure, damper=ball, duration=1.0)
    case = rb.Case(
        structure=structure,
        damper=rb.ParticleDamper(
            particles=rb.Particles(material="glass", diameter="3 mm", count=4),
            cavity=rb.Box(size=("20 mm",) * 3),
            contact=rb.Tsuji(restitution=0.9),
        ),
        duration=1.0,
    )
    assert rb.contact_pairs(one) == rb.contact_pairs(one, 0) == rb.contact_pairs(one, -1)
    with pytest.raises(rb.CaseError, match="index = 1, but the case has 1 impact damper\n  try: index = 0"):
        rb.contact_pairs(one, 1)
    with pytest.raises(rb.CaseError, match="0 impact dampers"):
        rb.contact_pairs(one.model_copy(update={"dampers": ()}))
    with pytest.raises(rb.CaseError, match="the case has particle dampers") as caught:
        rb.contact_pairs(case)
    between, wall = eval(caught.value.suggestion, {"case": case})
    assert (between.is_wall, wall.is_wall) == (False, True)


def test_every_material_is_physical_and_has_a_source() -> None:
    """The library has the documented materials, each with a source; brittle materials have no yield stress."""
    library = rb.materials()
    assert {"steel", "stainless_steel", "tungsten_carbide", "lead", "brass", "aluminium"} <= set(library)
    assert {"glass", "alumina", "zirconia", "pmma", "nylon", "tungsten_alloy", "copper"} <= set(library)
    assert all(material.source for material in library.values())
    brittle = {name for name, material in library.items() if material.yield_stress is None}
    assert brittle == {"tungsten_carbide", "glass", "alumina", "zirconia"}
    steel = library["steel"]
    assert (steel.young, steel.poisson, steel.density, steel.yield_stress) == (200e9, 0.3, 7850.0, 1030e6)


def test_library_agrees_with_its_sources() -> None:
    """The values of lead and alumina are those of the tables named as their sources."""
    lead, alumina = rb.materials()["lead"], rb.materials()["alumina"]
    assert (lead.density, lead.young, lead.poisson, lead.yield_stress) == (11340.0, 13.5e9, 0.44, 7e6)
    assert (alumina.density, alumina.young, alumina.poisson) == (3984.0, 416e9, 0.231)


def test_a_ball_with_measured_mass_and_contact_time() -> None:
    """A ball with a given mass and contact time has them for any modulus of its material."""
    for material in ("steel", "nylon"):
        ball = rb.Sphere(diameter="24 mm", material=material, mass="36 g")
        damper = rb.ImpactDamper(
            ball=ball,
            gap="2 mm",
            velocity="1 m/s",
            contact=rb.Linear(contact_time="2.1 ms", restitution=0.45, ending="zero_overlap"),
        )
        impact = rb.simulate(rb.Case(structure=rb.Fixed(), damper=damper, duration="5.5 ms")).impacts
        zeta = -math.log(0.45) / math.hypot(math.log(0.45), math.pi)
        assert impact.duration[0] == pytest.approx(2.1e-3 / math.sqrt(1 - zeta**2), rel=1e-9)
        assert impact.separation_speed[0] / impact.approach_speed[0] == pytest.approx(0.45, rel=1e-9)


def test_parts_are_immutable() -> None:
    """Fields of a part cannot be assigned, and a copy with an unknown field is refused; both messages give advice."""
    with pytest.raises(rb.CaseError, match=r"^radius: a Sphere .*\n  try: .*case\.replaced"):
        BALL.radius = 1.0  # type: ignore[misc]
    with pytest.raises(rb.CaseError, match=r"Case has no field 'damper'\n  try: did you mean 'dampers'"):
        rb.Case(structure=rb.Fixed(), duration=1).model_copy(update={"damper": None})


def test_a_case_with_other_values_is_another_case() -> None:
    """`Case.replaced` sets values by path in a copy; the original does not change, and invalid values are refused."""
    damper = rb.ImpactDamper(ball=BALL, gap="1 mm", contact=rb.Tsuji(restitution=0.9))
    case = rb.Case(structure=rb.SDOF(mass=1, stiffness=4e3, damping=1), damper=damper, duration=1)
    other = case.replaced({"damper.gap": "2 mm", "duration": "2 s", "structure.damping_ratio": "1 %"})
    assert (other.dampers[0].gap, other.duration, case.dampers[0].gap, case.duration) == (2e-3, 2, 1e-3, 1)
    assert other.replaced({"damper.gap": 1e-3, "duration": 1, "structure.damping": 1}) == case
    with pytest.raises(rb.CaseError, match=r"damper.gap = '2 kg'\n  a length \(m\) is needed"):
        case.replaced({"damper.gap": "2 kg"})


def test_a_copy_recomputes_its_modes() -> None:
    """A copy with another structure has the modes of that structure; the original has its own."""
    case = rb.Case(structure=rb.SDOF(mass=1.0, stiffness=4.0), duration=1.0)
    copy = case.model_copy(update={"structure": rb.SDOF(mass=1.0, stiffness=9.0)})
    assert (case.modes.stiffness, copy.modes.stiffness, case.model_copy().modes.stiffness) == (4.0, 9.0, 4.0)


@pytest.mark.parametrize("seed", [-1, 2**63, 99999999999999999999])
def test_seeds_beyond_64_bits_are_refused(seed: int) -> None:
    """A seed outside the range of a 64-bit signed integer is refused; the largest one is accepted."""
    options = {"structure": rb.SDOF(mass=1, stiffness=1), "duration": 1}
    assert rb.Case(**options, seed=2**63 - 1).seed == 2**63 - 1
    with pytest.raises(rb.CaseError) as caught:
        rb.Case(**options, seed=seed)
    limit, nearest = ("must be at least 0", 0) if seed < 0 else ("must be at most 9.22337e+18", 2**63 - 1)
    assert str(caught.value).splitlines() == [f"Case: seed = {seed}", f"  {limit}", f"  try: seed = {nearest}"]


def test_the_library_of_materials_is_a_copy() -> None:
    """Changing the returned dictionary does not change the library."""
    rb.materials().pop("steel")
    assert rb.Sphere(radius="1 mm", material="steel").material.density == 7850


def test_an_alias_without_a_value_is_not_given() -> None:
    """A program that passes `damper=None` together with `dampers` has a case; it was refused as if both were given."""
    soft = rb.Linear(stiffness="3 MN/m", restitution=0.4)
    ball = rb.ImpactDamper(ball=rb.Striker(mass="40 g"), gap="0.6 mm", contact=soft)
    usual = {"structure": rb.SDOF(mass="3 kg", frequency="17 Hz"), "duration": "0.2 s", "dampers": [ball, ball]}
    assert rb.Case(**usual, damper=None) == rb.Case(**usual)
    with pytest.raises(rb.CaseError, match="give damper or dampers, not both\n  try: all of them in dampers"):
        rb.Case(**usual, damper=ball)
