"""Variants packed by broadcasting have the same bits as variants packed one by one."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.core import _core
from rattlebox.model.paths import replaced
from rattlebox.prepare import pack as packing
from rattlebox.prepare.pack import pack, pack_parts
from rattlebox.prepare.variants import compare

CONSTANT = rb.Tsuji(alpha=0.006313, ending="zero_overlap")
PLASTIC = rb.Tsuji(restitution=rb.JacksonGreen(), ending="zero_overlap")
PLASTIC_RIGID = rb.Tsuji(restitution=rb.JacksonGreen(wall="rigid"), ending="zero_overlap")
BALL = rb.Sphere(radius="10 mm", material="steel")
YIELDING = rb.reference_case(PLASTIC)
ROW = rb.ImpactDamper(
    balls=[rb.Sphere(radius=0.004 + 0.001 * i, material=name) for i, name in enumerate(["steel", "brass", "lead"])],
    gap="1 mm",
    start=[-0.5, 0.0, "0.3 mm"],
    velocity=[0.1, 0.2, 0.3],
    wall="aluminium",
    contact=rb.Tsuji(restitution=rb.JacksonGreen(extrapolate=True)),
    ball_contact=rb.Linear(stiffness="1 MN/m", restitution=0.8),
)
MANY_MODES = rb.Modal(
    frequencies=[1.1 + 3.7 * k for k in range(11)],
    damping_ratios=[0.01] * 11,
    shapes={"tip": [0.3 + 0.1 * k for k in range(11)], "root": [0.05] * 11},
    participation=[0.7] * 11,
)
TWO_MODES = rb.Modal(frequencies=[1.0, 2.0], damping_ratios=[0.0, 0.0], shapes={"mass": [1.0, 1.0]})
BEAM = rb.Case(
    structure=MANY_MODES,
    dampers=[
        rb.ImpactDamper(ball=BALL, gap="0.4 mm", contact=CONSTANT, point="tip", name="end"),
        ROW.model_copy(update={"point": "root"}),
    ],
    loads=[
        rb.Harmonic(amplitude="3 N", frequency="10 Hz", point="tip"),
        rb.HalfSine(amplitude=5.0, duration=0.1, point="root"),
    ],
    base=rb.Harmonic(amplitude="2 m/s^2", frequency="7.3 Hz"),
    duration=2.0,
)
SHAKEN = rb.Case(
    structure=rb.Shaker(motion=rb.Harmonic(amplitude="1.3 mm", frequency="12 Hz")),
    damper=rb.ImpactDamper(ball=BALL, gap="5 mm", contact=rb.Linear(contact_time="0.1 ms", restitution=0.7)),
    duration=1.0,
)
FRAME = rb.Case(
    structure=rb.Matrices(M=[[2.0, 0.3], [0.3, 1.0]], K=[[4e4, -1e4], [-1e4, 3e4]], points={"top": [0.2, 1.0]}),
    damper=rb.ImpactDamper(ball=BALL, gap="0.4 mm", contact=CONSTANT),
    duration=1.0,
)


def pack_batch(case: rb.Case, columns: Mapping[str, Any], shape: Sequence[int]) -> _core.Problem:
    """Return the first batch of variants; raise if they need several for which the first one states a reason."""
    first, *others = pack_parts(case, columns, shape)
    if others and first.obstacle:
        raise first.obstacle
    return first.packed


def variants(case: rb.Case, columns: Mapping[str, Any]) -> tuple[_core.Problem, list[tuple[tuple[int, ...], rb.Case]]]:
    """Return the batch of a case over columns and all its members, made one by one."""
    shape = np.broadcast_shapes(*(np.shape(values) for values in columns.values()))
    members = [
        (
            index,
            replaced(
                case,
                {
                    path: np.asarray(values)[
                        tuple(0 if n == 1 else i for n, i in zip(np.shape(values), index, strict=True))
                    ]
                    for path, values in columns.items()
                },
            ),
        )
        for index in itertools.product(*map(range, shape))
    ]
    return pack_batch(case, columns, shape), members


def differences(one: Any, batch: Any, index: tuple[int, ...], where: str = "") -> Iterator[str]:
    """Find what is not the same, to the last bit, in a packed case and a member of a batch."""
    if isinstance(one, _core.Node):
        assert type(one) is type(batch)
        for key in one.fields():
            yield from differences(getattr(one, key), getattr(batch, key), index, f"{where}.{key}")
    elif isinstance(one, list):
        for number, (item, other) in enumerate(zip(one, batch, strict=True)):
            yield from differences(item, other, index, f"{where}[{number}]")
    else:
        member = batch
        if isinstance(batch, np.ndarray):
            assert batch.flags.c_contiguous
            grid = batch.shape[np.ndim(one) :]
            assert len(grid) in (0, len(index))
            member = batch[(..., *(0 if n == 1 else i for n, i in zip(grid, index, strict=True)))] if grid else batch
        if not np.array_equal(one, member):
            yield f"{where}: {one} {member}"


def check(case: rb.Case, columns: Mapping[str, Any]) -> _core.Problem:
    """Hold each member of a batch against the case packed alone; the members must not all be the same."""
    packed, members = variants(case, columns)
    alone = [without_samples(pack(member)) for _, member in members]
    for (index, _), one in zip(members, alone, strict=True):
        assert list(differences(one, packed, index)) == []
    assert len({repr(one) for one in alone}) > 1
    return packed


def without_samples(problem: _core.Problem) -> _core.Problem:
    """Return a packed case without sample times, which a batch does not have."""
    settings = problem.settings.replace(contact_samples=0, keep_end=False)
    return problem.replace(settings=settings, sample_times=np.zeros(0))


def between(smallest: float, largest: float, count: int = 7) -> np.ndarray:
    """Return numbers without round binary digits."""
    return np.random.default_rng(count).uniform(smallest, largest, count)


def objects(*values: Any) -> np.ndarray:
    """Return values as an array of objects."""
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array


@pytest.mark.parametrize(
    ("case", "path", "values"),
    [
        (YIELDING, "structure.mass", between(5, 30)),
        (YIELDING, "structure.stiffness", between(1e4, 1e5)),
        (YIELDING, "structure.damping", between(0, 50)),
        (YIELDING, "structure.damping_ratio", between(0, 2)),
        (replaced(YIELDING, {"damper.gap": 1e-2}), "structure.displacement", between(-1e-3, 1e-3)),
        (YIELDING, "structure.velocity", between(-1, 1)),
        (YIELDING, "damper.ball.radius", between(0.01, 0.05)),
        (YIELDING, "damper.ball.diameter", between(0.01, 0.05)),
        (YIELDING, "damper.ball.mass", between(0.1, 2)),
        (YIELDING, "damper.ball.material.density", between(1e3, 9e3)),
        (YIELDING, "damper.ball.material.young", between(1e9, 3e11)),
        (YIELDING, "damper.ball.material.poisson", between(0.1, 0.49)),
        (YIELDING, "damper.ball.material.yield_stress", between(1e8, 2e9)),
        (YIELDING, "damper.gap", between(1e-4, 2e-3)),
        (YIELDING, "damper.cavity_length", between(0.067, 0.08)),
        (YIELDING, "damper.start", between(-1, 1)),
        (YIELDING, "damper.velocity", between(-1, 1)),
        (YIELDING, "damper.gravity", between(-9.81, 9.81)),
        (YIELDING, "damper.contact.alpha", between(0, 0.5)),
        (YIELDING, "damper.contact.restitution", between(0.1, 1)),
        (YIELDING, "damper.contact.restitution.yield_stress", between(1e8, 2e9)),
        (YIELDING, "damper.contact.restitution.maximum", between(0.5, 1)),
        (YIELDING, "load.amplitude", between(1, 5e3)),
        (YIELDING, "load.duration", between(1e-3, 1e-2)),
        (YIELDING, "load.start", between(0, 1)),
        (YIELDING, "duration", between(1, 10)),
        (YIELDING, "method.tolerance", between(1e-13, 1e-10)),
        (rb.reference_case(PLASTIC, method=rb.TwoStep()), "method.dt_contact", between(1e-8, 1e-7)),
        (rb.reference_case(CONSTANT, method=rb.Newton()), "method.stick", between(1e-7, 1e-5)),
        (rb.reference_case(CONSTANT, method=rb.Newton()), "method.restitution", between(0, 1)),
        (rb.reference_case(CONSTANT, method=rb.Newton()), "damper.contact.alpha", between(0, 2)),
        (
            rb.reference_case(rb.Tsuji(alpha=0.1), method=rb.Newton()),
            "damper.contact.alpha",
            np.append(between(0, 5), np.sqrt(5)),
        ),
        (rb.reference_case(rb.Linear(stiffness=1e6, damping=3.0)), "damper.contact.stiffness", between(1e5, 1e7)),
        (rb.reference_case(rb.Linear(stiffness=1e6, damping=3.0)), "damper.contact.damping", between(0, 100)),
        (rb.reference_case(rb.Linear(stiffness=1e6, damping=3.0)), "damper.contact.contact_time", between(1e-5, 1e-3)),
        (
            rb.reference_case(rb.Linear(stiffness=1e6, damping=3.0), method=rb.Newton()),
            "damper.contact.damping",
            between(0, 1e4),
        ),
        (rb.reference_case(rb.Thornton()), "damper.ball.radius", between(0.01, 0.05)),
        (rb.reference_case(rb.Thornton(), method=rb.Newton()), "damper.contact.yield_pressure", between(1e8, 3e9)),
        (rb.reference_case(rb.Tsuji(restitution=rb.ThorntonRestitution())), "damper.ball.radius", between(0.01, 0.05)),
        (rb.reference_case(rb.Tsuji(restitution=rb.Johnson())), "damper.ball.material.yield_stress", between(1e8, 2e9)),
        (
            rb.reference_case(rb.Tsuji(restitution=rb.Johnson())),
            "damper.contact.restitution.speed_scale",
            between(1e-3, 1),
        ),
        (rb.reference_case(PLASTIC).replaced({"damper.wall": "rigid"}), "damper.ball.radius", between(0.01, 0.05)),
        (rb.reference_case(PLASTIC_RIGID), "structure.mass", between(5, 30)),
        (BEAM, "structure.frequencies[2]", between(1, 100)),
        (BEAM, "structure.damping_ratios[0]", between(0, 1.5)),
        (BEAM, "structure.shapes.tip[9]", between(-1, 1)),
        (BEAM, "structure.participation[10]", between(-1, 1)),
        (BEAM, "dampers[0].ball.radius", between(0.001, 0.02)),
        (BEAM, "dampers[1].balls[1].radius", between(0.001, 0.02)),
        (BEAM, "dampers[1].balls[2].mass", between(0.001, 0.02)),
        (BEAM, "dampers[1].cavity_length", between(0.0310, 0.04)),
        (BEAM, "dampers[1].start[1]", between(-0.5, 0.3)),
        (BEAM, "dampers[1].velocity[2]", between(-1, 1)),
        (BEAM, "dampers[1].velocity", between(-1, 1)),
        (BEAM, "dampers[1].wall.poisson", between(0.1, 0.49)),
        (BEAM, "dampers[1].wall.yield_stress", between(1e6, 1e9)),
        (BEAM, "dampers[1].balls[0].material.yield_stress", between(1e6, 1e9)),
        (BEAM, "dampers[1].contact.restitution.yield_stress", between(1e6, 1e9)),
        (BEAM, "dampers[1].ball_contact.restitution.e", between(0, 1)),
        (BEAM, "loads[0].frequency", between(1, 100)),
        (BEAM, "loads[0].phase", between(-3, 3)),
        (BEAM, "loads[0].stop", between(0.1, 3)),
        (BEAM, "base.amplitude", between(1, 10)),
        (SHAKEN, "structure.motion.amplitude", between(1e-4, 1e-2)),
        (SHAKEN, "structure.motion.frequency", between(1, 100)),
        (SHAKEN, "damper.contact.restitution", between(0.1, 1)),
    ],
)
def test_numbers(case: rb.Case, path: str, values: np.ndarray) -> None:
    """A number that varies along an axis, alone or on a grid with gravity, gives the same bits as single cases."""
    check(case, {path: values})
    last = "damper" if len(case.dampers) == 1 else "dampers[1]"
    if path != "damper.gravity":
        check(case, {f"{last}.gravity": between(-9, 9, 3).reshape(3, 1), path: values[:3].reshape(1, 3)})


@pytest.mark.parametrize(
    ("case", "path", "values"),
    [
        (YIELDING, "damper.ball.material", ["steel", "brass", "lead", "brass"]),
        (YIELDING, "damper.wall", ["steel", "rigid", "aluminium", rb.materials()["brass"]]),
        (YIELDING, "damper.start", ["0.1 mm", -1, 0.25, "-0.0002 m"]),
        (YIELDING, "damper.contact.ending", ["zero_force", "zero_overlap"]),
        (YIELDING, "damper.contact.restitution.wall", ["rigid", None, "brass"]),
        (YIELDING, "damper.contact.restitution.extrapolate", [True, False]),
        (YIELDING, "structure.damping", [None, 3.0]),
        (YIELDING, "damper.contact", [rb.Tsuji(alpha=a) for a in (0.1, 0.2)]),
        (YIELDING, "structure", [rb.SDOF(mass=m, stiffness=1e4) for m in (1.0, 2.0)]),
        (BEAM, "dampers[1].balls[0].material", ["steel", "brass"]),
        (BEAM, "structure", [MANY_MODES, MANY_MODES.model_copy(update={"frequencies": [5.0] * 11})]),
        (BEAM, "dampers[0].point", ["tip", "root"]),
        (BEAM, "loads[0].point", ["tip", "root"]),
    ],
)
def test_what_is_no_number(case: rb.Case, path: str, values: list[Any]) -> None:
    """Names, laws and lists vary as long as the cases that they make differ in numbers only."""
    check(case, {path: objects(*values)})
    last = "damper" if len(case.dampers) == 1 else "dampers[1]"
    check(case, {path: objects(*values).reshape(-1, 1), f"{last}.gap": between(3e-4, 1e-3, 3).reshape(1, 3)})


def test_matrices() -> None:
    """Numbers inside matrices vary, alone and together with others."""
    check(FRAME, {"structure.K[0][0]": between(3e4, 6e4)})
    check(
        FRAME,
        {
            "structure.M[1][1]": between(1, 2, 3).reshape(3, 1, 1),
            "damper.gap": between(1e-4, 1e-3, 2).reshape(1, 2, 1),
            "structure.K[1][1]": between(3e4, 6e4, 4).reshape(1, 1, 4),
        },
    )


def test_linked_columns() -> None:
    """Several parameters of any kind vary along one axis, also with values that need each other."""
    n = 9
    packed = check(
        YIELDING,
        {
            "damper.ball.material": objects(*["steel", "glass", "steel"] * 3).reshape(n, 1),
            "damper.contact.restitution.yield_stress": between(1e8, 1e9, n).reshape(n, 1),
            "damper.ball.radius": between(0.01, 0.03, n).reshape(n, 1),
            "damper.cavity_length": between(0.07, 0.08, n).reshape(n, 1),
            "load.amplitude": between(1e3, 5e3, 4).reshape(1, 4),
        },
    )
    assert packed.dampers[0].mass.shape == (1, n, 1)


def test_a_grid_stays_small() -> None:
    """Numbers have the axes along which they vary, and no others."""
    axes = {
        "damper.gap": between(1e-4, 1e-3, 30),
        "load.amplitude": between(1, 5e3, 20),
        "damper.start": between(-1, 1, 10),
    }
    columns = {path: v.reshape([-1 if k == i else 1 for k in range(3)]) for i, (path, v) in enumerate(axes.items())}
    packed = pack_batch(YIELDING, columns, (30, 20, 10))
    (damper,) = packed.dampers
    assert damper.clearance.shape == (30, 1, 1)
    assert damper.position.shape == (1, 30, 1, 10)
    assert packed.loads[0].signal.amplitude.shape == (1, 20, 1)
    assert packed.mode_decay.shape == (1, 1, 1, 1)
    assert isinstance(packed.contacts[0].normal.stiffness, float)
    (part,) = packing.pack_parts(YIELDING, columns, (30, 20, 10))
    assert part.points["mass"].shape == (1, 1, 1, 1)


def test_no_axes() -> None:
    """A grid without axes is the case itself."""
    packed = pack_batch(YIELDING, {}, ())
    assert list(differences(without_samples(pack(YIELDING)), packed, ())) == []


@pytest.mark.parametrize(
    ("path", "values", "parts"),
    [
        (
            "damper.contact",
            [CONSTANT, PLASTIC],
            ["damper.contact", "differ in more than numbers", "a separate sweep for each value"],
        ),
        ("damper.contact", [CONSTANT, rb.Thornton()], ["damper.contact", "contacts"]),
        ("damper.contact.restitution", [rb.JacksonGreen(), rb.Constant(0.5)], ["restitution of contacts"]),
        ("damper.balls", [[BALL], [BALL, BALL]], ["damper.balls", "dampers"]),
        (
            "load",
            [rb.HalfSine(amplitude=1.0, duration=1.0), rb.Harmonic(amplitude=1.0, frequency=1.0)],
            ["load", "loads"],
        ),
        ("method", [rb.Newton(), rb.EventDriven()], ["method", "settings"]),
        ("method.max_events", [10, 20], ["max_events of settings"]),
        ("structure", [rb.SDOF(mass=1.0, stiffness=1.0), TWO_MODES], ["structure", "mode_decay"]),
        ("damper.gap", [1e-3, -1e-3], ["the variant with damper.gap = -0.001", "must not be negative"]),
        ("damper.start", [0.0, 1.01, 0.0], ["the variant with damper.start = 1.01", "inside a wall"]),
        (
            "damper.cavity_length",
            [0.07, 0.0663, 0.07],
            ["damper.cavity_length = 0.0663", "shorter than the row of balls"],
        ),
        ("damper.gpa", [1.0, 2.0], ["did you mean 'gap'?"]),
        ("damper.ball.material", ["steel", "stel"], ["did you mean 'steel'"]),
    ],
)
def test_what_does_not_fit(path: str, values: list[Any], parts: list[str]) -> None:
    """Objects that are not cases, and cases of different kinds, are refused with their index or the path."""
    column = np.array(values) if all(isinstance(value, (int, float)) for value in values) else objects(*values)
    with pytest.raises(rb.CaseError) as caught:
        pack_batch(YIELDING, {path: column}, column.shape)
    for part in parts:
        assert part in str(caught.value)


def test_one_wrong_start_among_many() -> None:
    """A ball that starts in a wall is found wherever it hides in a grid, wherever the structure is."""
    shape = (60, 50, 40)
    columns = {
        "damper.start": np.linspace(-0.5, 0.5, 60).reshape(60, 1, 1),
        "structure.displacement": np.linspace(0, 5e-3, 50).reshape(1, 50, 1),
        "damper.gap": np.linspace(1e-3, 2e-3, 40).reshape(1, 1, 40),
    }
    pack_batch(YIELDING, columns, shape)
    columns["damper.start"][27] = 1.25
    with pytest.raises(rb.CaseError, match=r"damper.start = 1.25.*"):
        pack_batch(YIELDING, columns, shape)


def test_overlapping_balls_are_found() -> None:
    """A ball that starts in another is found too."""
    starts = np.full(1000, 0.0)
    starts[477] = 0.5
    with pytest.raises(rb.CaseError, match=r"start\[1\] = 0\.5"):
        pack_batch(BEAM, {"dampers[1].start[1]": starts}, (1000,))


def test_a_formula_that_is_not_elementwise_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A formula that mixes members, or cannot take arrays, never gives a silently wrong batch."""
    gaps = {"damper.gap": between(1e-4, 1e-3)}
    monkeypatch.setattr(rb.ImpactDamper, "clearance", property(lambda damper: 2 * np.mean(damper.gap)))
    with pytest.raises(RuntimeError, match=r"dampers.0.clearance of variant"):
        pack_batch(YIELDING, gaps, (7,))
    monkeypatch.setattr(rb.ImpactDamper, "clearance", property(lambda damper: 2 * float(damper.gap)))
    with pytest.raises(TypeError) as caught:
        pack_batch(YIELDING, gaps, (7,))
    assert "elementwise" in caught.value.__notes__[0]


def test_comparison_allows_only_rounding() -> None:
    """A few units in the last place pass, more do not."""
    value = np.array([1.0, 0.1])
    compare({"a": 0.1}, {"a": value * (1 + 4e-16)}, (1,))
    with pytest.raises(RuntimeError, match="a of variant"):
        compare({"a": 0.1}, {"a": value * (1 + 2e-15)}, (1,))
    with pytest.raises(RuntimeError):
        compare({"a": 0.1}, {"a": np.array([np.nan, np.nan])}, (1,))


def test_columns_must_fit_the_grid() -> None:
    """Values of another shape than the grid's are refused."""
    for values, shape in ((np.zeros(3), (4,)), (np.zeros((3, 1)), (3,)), (0.5, (3,))):
        with pytest.raises(ValueError, match="do not broadcast"):
            pack_batch(YIELDING, {"damper.start": values}, shape)


def test_the_same_axis_may_be_a_view() -> None:
    """A column that repeats its values without storing them is taken."""
    gap = np.broadcast_to(between(1e-4, 1e-3, 3)[:, None], (3, 4))
    packed = pack_batch(YIELDING, {"damper.gap": gap}, (3, 4))
    assert np.array_equal(packed.dampers[0].clearance, 2 * gap)
    assert packing.pack(YIELDING).dampers[0].clearance == 8e-4


def test_cases_from_a_generator() -> None:
    """`simulate_many` accepts any iterable of cases."""
    runs = rb.simulate_many(rb.reference_case(duration=0.01 * k) for k in (1, 2))
    assert [run.arrays.time[-1] for run in runs] == [0.01, 0.02]
