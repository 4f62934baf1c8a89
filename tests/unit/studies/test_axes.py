"""Axes of a study: values and units, grids, random designs, replicas, bad axes."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rattlebox as rb
from rattlebox.model.paths import replaced
from rattlebox.studies.grid.axes import parse_axes, read_axes
from rattlebox.studies.grid.grid import Grid

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(scope="module")
def case() -> rb.Case:
    """Return a case with one steel ball that starts in the middle of a gap of 0.4 mm."""
    return rb.Case.from_file(EXAMPLES / "steel_ball.toml")


@pytest.fixture(scope="module")
def boxed() -> rb.Case:
    """Return a case with steel balls in a box."""
    return rb.Case.from_file(EXAMPLES / "steel_balls_in_a_box.toml")


@pytest.fixture(scope="module")
def row() -> rb.Case:
    """Return a case with five balls on a beam with two loads."""
    return rb.Case.from_file(EXAMPLES / "row_on_beam.toml")


@pytest.fixture(scope="module")
def shaker() -> rb.Case:
    """Return a case with one ball on a vertical shaker."""
    return rb.Case.from_file(EXAMPLES / "shaker.toml")


def refused(case: rb.Case, axes: Any) -> str:
    """Return the error message of bad axes, which must be short."""
    with pytest.raises(rb.CaseError) as caught:
        read_axes(case, axes)
    message = str(caught.value)
    assert message.startswith("axes: ")
    assert len(message.splitlines()) <= 6
    return message


def same(one: Grid, other: Grid) -> bool:
    """Return whether two designs have the same description."""
    return one.describe() == other.describe()


# ---- values


@pytest.mark.parametrize(
    ("path", "given", "values", "unit"),
    [
        ("damper.gap", ["0.1 mm", "200 um", 3e-4], [1e-4, 2e-4, 3e-4], "m"),
        ("damper.gap", rb.linspace("0.1 mm", "0.3 mm", 3), [1e-4, 2e-4, 3e-4], "m"),
        ("load.amplitude", rb.geomspace("10 N", "1 kN", 3), [10.0, 100.0, 1000.0], "N"),
        ("damper.gap", np.array([1e-4, 2e-4]), [1e-4, 2e-4], "m"),
        ("damper.gap", xr.DataArray([1e-4, 2e-4]), [1e-4, 2e-4], "m"),
        ("duration", range(1, 4), [1.0, 2.0, 3.0], "s"),
        ("structure.damping_ratio", [0, 0.01, np.float32(0.5)], [0.0, 0.01, 0.5], "1"),
        ("damper.contact.restitution", [0.5, 0.9], [0.5, 0.9], "1"),
        ("damper.contact.restitution", [rb.Constant(0.5), rb.Constant(0.9)], [0.5, 0.9], "1"),
        ("damper.velocity", ["0.1 m/s", "200 mm/s"], [0.1, 0.2], "m/s"),
        ("damper.ball.mass", ["1 kg", "2000 g"], [1.0, 2.0], "kg"),
        ("damper.ball.diameter", ["60 mm"], [0.06], "m"),
        ("damper.start", [-1, 0.5], [-1.0, 0.5], "1"),
        ("method.max_events", [1000, 2000], [1000.0, 2000.0], "1"),
    ],
)
def test_values_are_read_in_si(case: rb.Case, path: str, given: Any, values: list[float], unit: str) -> None:
    """Values in any form are stored in SI, and the coordinate has the unit and a long name."""
    design = read_axes(case, {path: given})
    assert design.columns[path].dtype == np.float64
    np.testing.assert_allclose(design.columns[path], values, rtol=1e-15)
    coord = xr.Dataset(coords=design.coords())[path]
    np.testing.assert_allclose(coord, values, rtol=1e-15)
    assert coord.attrs == {"units": unit, "long_name": path.replace(".", " ").replace("_", " ")}


def test_pint_quantities_are_read(case: rb.Case) -> None:
    """The unit of a pint array is converted."""
    from rattlebox.model.units import registry

    design = read_axes(case, {"damper.gap": np.array([0.1, 0.2]) * registry().millimeter})
    np.testing.assert_allclose(design.columns["damper.gap"], [1e-4, 2e-4], rtol=1e-15)


def test_places_in_lists_have_their_units(row: rb.Case) -> None:
    """Elements of lists can vary, in the unit of the list."""
    design = read_axes(
        row,
        {
            "structure.frequencies[0]": ["7 Hz", "9 Hz"],
            "loads[1].frequency": [f"{2 * np.pi} rad/s"],
            "damper.balls[2].diameter": ["7 mm"],
            "damper.start[0]": [-0.6],
            "damper.velocity": [0.1],
            "structure.shapes.tip[1]": [0.1, 0.2, 0.3],
        },
    )
    coords = design.coords()
    units = {name: attrs["units"] for name, (_, _, attrs) in coords.items()}
    assert units == {
        "structure.frequencies[0]": "Hz",
        "loads[1].frequency": "Hz",
        "damper.balls[2].diameter": "m",
        "damper.start[0]": "1",
        "damper.velocity": "m/s",
        "structure.shapes.tip[1]": "kg^-0.5",
    }
    np.testing.assert_allclose(design.columns["loads[1].frequency"].ravel(), [1.0], rtol=1e-15)
    last = design.case_at(row, design.size - 1)
    assert isinstance(last.structure, rb.Modal)
    assert last.structure.frequencies == [9.0, 23.0, 51.0]
    assert last.structure.shapes["tip"] == [0.5, 0.3, 0.2]
    assert last.dampers[0].start == [-0.6, -0.2, 0.0, 0.3, 0.6]


def test_names_and_parts_are_objects_with_labels(case: rb.Case) -> None:
    """Values other than numbers are objects in the column and short labels on the coordinate."""
    contacts = [rb.Tsuji(restitution=0.9), {"kind": "thornton"}, rb.Linear(stiffness="1 MN/m", damping=5)]
    design = read_axes(
        case,
        {
            "damper.ball.material": ["steel", "brass"],
            "damper.contact": contacts,
            "damper.wall": ["rigid", "steel"],
            "method.collocation": [True, False],
        },
    )
    assert all(column.dtype == object for column in design.columns.values())
    assert design.columns["damper.ball.material"].ravel().tolist() == [rb.materials()["steel"], rb.materials()["brass"]]
    labels = {name: values.tolist() for name, (_, values, _) in design.coords().items()}
    assert labels["damper.ball.material"] == ["steel", "brass"]
    assert labels["damper.contact"] == ["tsuji(restitution=0.9)", "thornton", "linear(damping=5, stiffness=1e+06)"]
    assert labels["damper.wall"] == ["rigid", "steel"]
    assert design.case_at(case, 4).dampers[0].contact == rb.Thornton()


def test_labels_of_different_objects_differ(case: rb.Case) -> None:
    """Two materials of one name have different labels."""
    steel = rb.materials()["steel"]
    soft = rb.Material(**{**dict(steel), "yield_stress": "500 MPa"})
    _, labels, _ = read_axes(case, {"damper.ball.material": [steel, soft]}).coords()["damper.ball.material"]
    assert labels.tolist() == ["steel (1)", "steel (2)"]


def test_materials_of_the_case_are_available_by_name() -> None:
    """A material of the case can be named on an axis."""
    case = rb.Case(
        structure=rb.Fixed(),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="5 mm", material=rb.Material(name="oak", density=700, young="10 GPa", poisson=0.3)),
            gap="1 mm",
            contact=rb.Tsuji(restitution=0.5),
        ),
        duration=1,
    )
    design = read_axes(case, {"damper.ball.material": ["steel", "oak"]})
    assert [design.case_at(case, i).dampers[0].balls[0].material.name for i in (0, 1)] == ["steel", "oak"]


# ---- dimensions


def test_grid_has_one_dimension_an_item(case: rb.Case) -> None:
    """Each column of a grid has its own dimension, and the last one varies fastest."""
    design = read_axes(case, {"damper.gap": ["1 mm", "2 mm", "3 mm"], "load.amplitude": ["1 kN", "5 kN"]})
    assert (design.dims, design.shape, design.size) == (("damper.gap", "load.amplitude"), (3, 2), 6)
    assert {path: column.shape for path, column in design.columns.items()} == {
        "damper.gap": (3, 1),
        "load.amplitude": (1, 2),
    }
    variant = design.case_at(case, 3)
    assert (variant.dampers[0].gap, variant.loads[0].amplitude) == (2e-3, 5000.0)
    assert replaced(variant, {"damper.gap": "0.4 mm", "load.amplitude": "5 kN"}) == case


def test_linked_parameters_share_a_dimension(case: rb.Case) -> None:
    """Linked paths vary along one dimension, which has a given name or that of the first path."""
    gaps, loads = ["1 mm", "2 mm"], rb.linspace("1 kN", "5 kN", 2)
    tied = read_axes(case, {("damper.gap", "load.amplitude"): (gaps, loads), "duration": [1, 2]})
    named = read_axes(case, {"level": {"damper.gap": gaps, "load.amplitude": loads}, "duration": [1, 2]})
    assert (tied.dims, tied.shape) == (("damper.gap", "duration"), (2, 2))
    assert (named.dims, named.shape) == (("level", "duration"), (2, 2))
    for design in (tied, named):
        assert design.columns["damper.gap"].shape == design.columns["load.amplitude"].shape == (2, 1)
        variant = design.case_at(case, 2)
        assert (variant.dampers[0].gap, variant.loads[0].amplitude, variant.duration) == (2e-3, 5000.0, 1.0)
        dims = {name: dim for name, (dim, _, _) in design.coords().items()}
        assert dims["load.amplitude"] == dims["damper.gap"] == design.dims[0]
    assert named.coords()["level"][1].tolist() == [0, 1]


def test_exclusive_fields_replace_each_other(case: rb.Case) -> None:
    """An axis over a damping ratio, cavity length or diameter replaces the alternative field of the case."""
    design = read_axes(
        case,
        {"structure.damping_ratio": [0.1], "damper.cavity_length": ["68 mm"], "damper.ball.diameter": ["66 mm"]},
    )
    variant = design.case_at(case, 0)
    assert isinstance(variant.structure, rb.SDOF)
    assert (variant.structure.damping, variant.structure.damping_ratio) == (None, 0.1)
    assert variant.dampers[0].balls[0].radius == 0.033
    assert variant.dampers[0].gap == pytest.approx(1e-3, rel=1e-12)


def test_a_part_and_its_field_may_both_vary(case: rb.Case) -> None:
    """The contact is replaced first, then its restitution."""
    laws = [rb.Tsuji(restitution=0.1, ending=ending) for ending in ("zero_force", "zero_overlap")]
    design = read_axes(case, {"damper.contact": laws, "damper.contact.restitution": [0.5, 0.9]})
    contact = design.case_at(case, 3).dampers[0].contact
    assert contact == rb.Tsuji(restitution=0.9, ending="zero_overlap")


# ---- starts and replicas


def test_lengths_of_the_start_become_fractions_of_each_gap(case: rb.Case) -> None:
    """A start given as a length is that length for every gap."""
    design = read_axes(case, {"damper.gap": ["0.1 mm", "1 mm"], "damper.start": ["50 um", "-0.02 mm"]})
    np.testing.assert_allclose(design.columns["damper.start"], [[0.5, -0.2], [0.05, -0.02]], rtol=1e-14)
    assert design.coords()["damper.start"][2]["units"] == "m"
    for index, place in enumerate([5e-5, -2e-5, 5e-5, -2e-5]):
        np.testing.assert_allclose(design.case_at(case, index).dampers[0].positions0, [place], rtol=1e-14)


@pytest.mark.parametrize("size", ["damper.ball.radius", "damper.ball.diameter"])
def test_lengths_of_the_start_with_a_cavity_length(case: rb.Case, size: str) -> None:
    """A start given as a length is exact if the gap follows from the cavity length and a varying ball."""
    sizes = ["30 mm", "33 mm"] if size.endswith("radius") else ["60 mm", "66 mm"]
    design = read_axes(
        case, {"damper.cavity_length": ["67 mm", "70 mm"], size: sizes, "damper.start": ["0.1 mm", "0.3 mm"]}
    )
    for index in range(design.size):
        place = [1e-4, 3e-4][index % 2]
        np.testing.assert_allclose(design.case_at(case, index).dampers[0].positions0, [place], rtol=1e-12)


def test_replicas_are_offsets_from_the_case_or_an_axis(case: rb.Case) -> None:
    """Offsets are spread evenly over the reach on both sides, and each variant has the same offsets."""
    axes = {"damper.gap": ["0.1 mm", "1 mm"], "structure.mass": [10, 20]}
    moved = rb.replicas({"damper.start": "1 um", "structure.mass": "10 g"}, 64, seed=3)
    design = read_axes(case, [axes, moved])
    assert (design.dims, design.shape) == (("damper.gap", "structure.mass", "replica"), (2, 2, 64))
    assert design.columns["damper.start"].shape == (2, 1, 64)
    assert design.columns["structure.mass"].shape == (1, 2, 64)
    coords = xr.Dataset(coords=design.coords())
    offsets = coords["damper.start.offset"]
    assert offsets.attrs["units"] == "m"
    assert offsets.dims == ("replica",)
    counts, _ = np.histogram(offsets, bins=64, range=(-1e-6, 1e-6))
    assert (counts == 1).all()
    start = design.columns["damper.start"][:, 0] * [[1e-4], [1e-3]]
    np.testing.assert_allclose(start, np.broadcast_to(offsets, (2, 64)), rtol=1e-14)
    mass = design.columns["structure.mass"][0] - [[10.0], [20.0]]
    np.testing.assert_allclose(mass, np.broadcast_to(coords["structure.mass.offset"], (2, 64)), atol=1e-14)
    np.testing.assert_array_equal(coords["structure.mass"], [10.0, 20.0])


def test_replicas_of_a_start_at_a_wall_stay_inside(case: rb.Case) -> None:
    """A start beyond a wall of the cavity, also of a displaced one, is mirrored at the wall."""
    for displacement in (0.0, 3e-4):
        here = replaced(case, {"structure.displacement": displacement, "damper.start": 0.0})
        axes = [{"damper.start": [-1, 0, 1]}, rb.replicas({"damper.start": "1 um"}, 8)]
        start = read_axes(here, axes).columns["damper.start"]
        assert np.abs(start).max() <= 1 + 1e-12
        np.testing.assert_allclose(start[2], -np.sign(start[1]) * start[1] + 1, rtol=1e-12)
        np.testing.assert_allclose(start[0], -start[2], rtol=1e-12)


def test_replicas_of_a_gap_and_a_restitution(case: rb.Case) -> None:
    """The start in lengths refers to the offset gap; the offset of a constant restitution is added to its number."""
    here = replaced(case, {"damper.contact.restitution": 0.9})
    reach = {"damper.gap": "0.1 mm", "damper.start": "10 um", "damper.contact.restitution": 0.05}
    design = read_axes(here, rb.replicas(reach, 16))
    coords = design.coords()
    np.testing.assert_allclose(
        design.columns["damper.start"] * design.columns["damper.gap"], coords["damper.start.offset"][1], rtol=1e-13
    )
    np.testing.assert_allclose(
        design.columns["damper.contact.restitution"] - 0.9, coords["damper.contact.restitution.offset"][1], atol=1e-15
    )


# ---- parsed axes


def test_parsed_axes_follow_the_gap_of_another_case(case: rb.Case) -> None:
    """A start given as a length is that length in a case with another gap, without parsing it again."""
    axes = parse_axes(case, {"damper.start": ["50 um", "-0.1 mm"]})
    for gap in (1e-4, 1e-3):
        other = replaced(case, {"damper.gap": gap})
        np.testing.assert_allclose(axes.grid(other).columns["damper.start"], [5e-5 / gap, -1e-4 / gap], rtol=1e-14)


def test_parsed_axes_are_refused_for_another_unit() -> None:
    """Amplitudes that were parsed as displacements are not read as accelerations in another case."""

    def shaken(motion: rb.Harmonic) -> rb.Case:
        ball = rb.Sphere(radius="10 mm", material="steel")
        damper = rb.ImpactDamper(ball=ball, gap="1 mm", contact=rb.Tsuji(restitution=0.6))
        return rb.Case(structure=rb.Shaker(motion=motion), damper=damper, duration="1 s")

    moved = shaken(rb.Harmonic(amplitude="1 mm", frequency="10 Hz"))
    axes = parse_axes(moved, {"structure.motion.amplitude": ["1 mm", "2 mm"]}, source="levels")
    assert axes.grid(moved).columns["structure.motion.amplitude"].tolist() == [1e-3, 2e-3]
    with pytest.raises(rb.CaseError, match=r"levels: structure.motion.amplitude\n  its unit is m/s\^2, .* for m"):
        axes.grid(shaken(rb.Harmonic(amplitude="1 m/s^2", frequency="10 Hz")))


# ---- random designs


@pytest.mark.parametrize("method", ["sobol", "halton", "lhs", "random"])
def test_random_points_fill_their_ranges(case: rb.Case, method: Any) -> None:
    """Points are spread evenly over their ranges, in the logarithm if requested: a quarter of them in each quarter."""
    ranges = {"damper.gap": ("0.1 mm", "2 mm"), "load.amplitude": ("10 N", "1000 N")}
    random = rb.random_design(ranges, 1000, method=method, log=["load.amplitude"])
    design = read_axes(case, random)
    assert (design.dims, design.shape) == (("sample",), (1000,))
    parts = {
        "gap": (design.columns["damper.gap"] - 1e-4) / 1.9e-3,
        "load": np.log10(design.columns["load.amplitude"] / 10) / 2,
    }
    slack = 75 if method == "random" else 10  # four standard deviations, and a few points
    for part in parts.values():
        assert part.min() >= 0
        assert part.max() <= 1
        counts, _ = np.histogram(part, bins=4, range=(0, 1))
        assert np.abs(counts - 250).max() <= slack


def test_random_designs_repeat_and_differ_by_seed(case: rb.Case) -> None:
    """A seed fixes the design, another seed gives another one, and a longer Sobol design begins with the shorter."""
    ranges = {"damper.gap": ("0.1 mm", "2 mm")}
    design = read_axes(case, rb.random_design(ranges, 10, seed=1))
    assert same(design, read_axes(case, rb.random_design(ranges, 10, seed=1)))
    assert not same(design, read_axes(case, rb.random_design(ranges, 10, seed=2)))
    longer = read_axes(case, rb.random_design(ranges, 100, seed=1))
    np.testing.assert_array_equal(longer.columns["damper.gap"][:10], design.columns["damper.gap"])


def test_random_designs_choose_materials(case: rb.Case) -> None:
    """Choices from a list are drawn about equally often."""
    names = ["steel", "brass", "glass"]
    design = read_axes(case, rb.random_design({"damper.ball.material": names, "duration": (1, 2)}, 300))
    _, labels, _ = design.coords()["damper.ball.material"]
    assert {name: (labels == name).sum() for name in names} == pytest.approx(dict.fromkeys(names, 100), abs=3)


# ---- the design as a whole


def test_description_is_plain_and_equal_for_equal_designs(case: rb.Case) -> None:
    """Descriptions are JSON, do not depend on the units of values, and differ if any value differs."""
    spelt = [
        [
            {"damper.gap": ["1 mm", "2 mm"], "damper.ball.material": ["steel"]},
            rb.replicas({"damper.start": "1 um"}, 50),
        ],
        [
            {"damper.gap": rb.linspace(1e-3, "0.2 cm", 2), "damper.ball.material": [rb.materials()["steel"]]},
            rb.replicas({"damper.start": 1e-6 * rb_metre()}, 50),
        ],
    ]
    one, other = (read_axes(case, axes) for axes in spelt)
    assert same(one, other)
    assert json.loads(json.dumps(one.describe())) == one.describe()
    many = np.linspace(1e-4, 1e-3, 1000)
    moved = many.copy()
    moved[500] *= 1 + 2e-16
    designs = [
        read_axes(case, axes)
        for axes in (
            {"damper.gap": many},
            {"damper.gap": moved},
            {"damper.gap": many, "duration": [1]},
            {"damper.gap": [1e-3, 2e-3], "duration": [1, 2]},
            {"duration": [1, 2], "damper.gap": [1e-3, 2e-3]},
            {"damper.ball.material": ["steel", "brass"] * 10},
            {"damper.ball.material": ["brass", "steel"] * 10},
        )
    ]
    described = [json.dumps(design.describe()) for design in designs]
    assert len(set(described)) == len(designs)
    assert max(map(len, described)) < 2000


def rb_metre() -> Any:
    """Return one metre as a pint quantity."""
    from rattlebox.model.units import registry

    return registry().meter


def test_designs_can_be_pickled(case: rb.Case) -> None:
    """A pickled and restored design is equal."""
    design = read_axes(case, [{"damper.ball.material": ["steel", "brass"]}, rb.replicas({"damper.start": 0.01}, 3)])
    copy = pickle.loads(pickle.dumps(design))
    assert same(copy, design)
    assert copy.case_at(case, 5) == design.case_at(case, 5)


def test_a_million_variants_are_light(case: rb.Case) -> None:
    """A grid of a million variants stores its axes only, and its description is short."""
    grid = read_axes(case, {"damper.gap": np.linspace(1e-4, 2e-3, 1000), "load.amplitude": np.linspace(1, 9e3, 1000)})
    assert grid.size == 10**6
    assert sum(column.nbytes for column in grid.columns.values()) == 16000
    random = read_axes(case, rb.random_design({"damper.gap": ("0.1 mm", "2 mm")}, 10**6, method="lhs"))
    assert len(json.dumps(random.describe())) < 1000


@pytest.mark.parametrize("index", [-1, 2])
def test_variants_that_do_not_exist_are_refused(case: rb.Case, index: int) -> None:
    """The index of a variant is from 0 to the size less one."""
    with pytest.raises(rb.CaseError, match="is not the number of a variant"):
        read_axes(case, {"duration": [1, 2]}).case_at(case, index)


# ---- bad axes


@pytest.mark.parametrize(
    ("axes", "pattern"),
    [
        ({}, ["nothing varies", "damper.gap"]),
        (5, ["5 is not a mapping"]),
        ({"damper.gapp": [1]}, ["damper.gapp", "did you mean 'gap'?"]),
        ({3: [1]}, ["3 is not a path"]),
        ({"": [1]}, ["'' is not a path"]),
        ({"damper.gap": []}, ["damper.gap", "there are no values"]),
        ({"damper.gap": "1 mm"}, ["damper.gap = '1 mm'", "a list of values is needed", "['1 mm']"]),
        ({"damper.gap": 1e-3}, ["damper.gap = 0.001", "a list of values is needed"]),
        ({"damper.gap": np.array(1e-3)}, ["damper.gap", "a list of values is needed"]),
        ({"damper.gap": ["1 mm", "2 kg"]}, ["damper.gap[1] = '2 kg'", "a length (m) is needed, not a mass"]),
        ({"damper.gap": ["1 mmm"]}, ["damper.gap[0]", "unknown unit 'mmm'", "did you mean 'mm'?"]),
        ({"damper.gap": [1e-3, float("nan")]}, ["damper.gap[1] = nan", "finite"]),
        ({"damper.gap": np.array([1e-3, np.inf])}, ["damper.gap[1] = inf", "finite"]),
        ({"damper.gap": [1e-3, -1e-3]}, ["damper.gap[1] = -0.001", "negative"]),
        ({"damper.gap": np.ones((2, 2))}, ["damper.gap[0]", "a length (m) is needed"]),
        ({"damper.gap": [True]}, ["damper.gap[0] = True", "a length (m) is needed"]),
        ({"load.amplitude": ["1 mm"]}, ["load.amplitude[0] = '1 mm'", "a force (N) is needed, not a length"]),
        ({"damper.contact.restitution": [0.5, 1.2]}, ["damper.contact.restitution[1] = 1.2", "between 0"]),
        ({"damper.ball.material": ["stel"]}, ["damper.ball.material[0] = 'stel'", "did you mean 'steel'?"]),
        ({"damper.contact": [{"kind": "tsuj"}]}, ["damper.contact[0].kind = 'tsuj'", "did you mean 'tsuji'?"]),
        ({"structure.mass": [1, 0]}, ["structure.mass[1] = 0", "greater than zero"]),
        ({"damper.gap": rb.linspace("1 mm", -2, 3)}, ["damper.gap, stop = -2", "must not be negative"]),
        ({"damper.gap": rb.geomspace("1 N", "1 kN", 3)}, ["damper.gap, start = '1 N'", "not a force"]),
        ({"damper.ball.material": rb.linspace(0, 1, 3)}, ["damper.ball.material", "not numbers"]),
        ({"damper.gap": [1e-3], "dampers[0].gap": [1e-3]}, ["dampers[0].gap varies twice, also as damper.gap"]),
        (
            [{"damper.gap": [1e-3]}, rb.random_design({"damper.gap": (1e-4, 1e-3)}, 2)],
            ["damper.gap varies twice"],
        ),
        ({"damper.gap": [1e-3], "damper.cavity_length": [0.07]}, ["damper.gap and damper.cavity_length exclude"]),
        ([{"damper.cavity_length": [0.07]}, rb.replicas({"damper.gap": 1e-6}, 2)], ["exclude each other"]),
        (
            {("damper.gap", "load.amplitude"): [("1 mm", "1 kN"), ("2 mm", "2 kN"), ("3 mm", "3 kN")]},
            ["number of lists"],
        ),
        (
            {("damper.gap", "load.amplitude"): (["1 mm"], [1, 2])},
            ["same number of values", "damper.gap has 1, load.amplitude has 2"],
        ),
        ([{"duration": [1]}, {"duration": [2]}], ["two dimensions are called 'duration'"]),
        ({"duration": {"damper.gap": [1e-3]}, "x": {"duration": [1]}}, ["the name of two dimensions"]),
        ({"damper.start": [0, "0.1 mm"]}, ["damper.start", "some are lengths"]),
        ({"damper.start": [0, 2]}, ["variant 1 is not valid: damper.start = 2", "inside a wall", "between -1 and 1"]),
        ({"damper.gap": ["0.1 mm", "1 mm"], "damper.start": ["0.2 mm"]}, ["variant 0", "inside a wall"]),
        ({"damper.gap": [0.0], "damper.start": ["1 um"]}, ["damper.start", "a gap greater than zero"]),
        (
            {"damper.cavity_length": [0.07], "damper.ball": [rb.Sphere(radius="1 mm", material="steel")]}
            | {"damper.start": ["1 um"]},
            ["damper.start", "varies as a whole"],
        ),
        (
            {"structure.stiffness": [0, 1], "structure.damping_ratio": [0.1]},
            ["variant 0 is not valid: structure.stiffness = 0 N/m", "no meaning without stiffness"],
        ),
        (rb.random_design({"damper.gap": ("2 mm", "1 mm")}, 4), ["damper.gap", "the first value must be the smaller"]),
        (rb.random_design({"damper.gap": "2 mm"}, 4), ["damper.gap", "a pair", '("0.1 mm", "2 mm")']),
        (rb.random_design({"damper.gap": (1, 2, 3)}, 4), ["damper.gap", "a pair"]),
        (rb.random_design({"damper.gap": (0, 1)}, 4, log=["damper.gap"]), ["damper.gap", "greater than zero"]),
        (rb.replicas({"damper.start": "-1 um"}, 4), ["damper.start, reach = '-1 um'", "greater than zero"]),
        (rb.replicas({"damper.start": 0.1, "dampers[0].start": 0.1}, 4), ["dampers[0].start varies twice"]),
        (rb.replicas({"damper.ball.material": "steel"}, 4), ["damper.ball.material", "reach"]),
        (rb.replicas({"damper.ball.mass": "1 g"}, 4), ["damper.ball.mass", "not one number"]),
        ([rb.replicas({"duration": 1}, 2), rb.replicas({"damper.start": 0.1}, 2)], ["two dimensions", "'replica'"]),
    ],
)
def test_bad_axes_are_refused_with_the_place_and_a_reason(case: rb.Case, axes: Any, pattern: list[str]) -> None:
    """Each wrong axis is refused with the path, the value and the allowed values."""
    message = refused(case, axes)
    for word in pattern:
        assert word in message, message


def test_values_of_another_dimension_are_refused(shaker: rb.Case) -> None:
    """The amplitude of a displacement cannot become an acceleration."""
    message = refused(shaker, {"structure.motion.amplitude": ["1 m/s^2"]})
    assert "a length (m) is needed, not an acceleration" in message
    assert read_axes(shaker, {"structure.motion.amplitude": ["0.1 mm"]}).coords()["structure.motion.amplitude"][2][
        "units"
    ] == ("m")


def test_an_index_is_needed_for_several_balls(row: rb.Case) -> None:
    """With several balls or positions, the message proposes paths with an index."""
    assert "balls[0] to damper.balls[4]" in refused(row, {"damper.balls.material": ["steel"]})
    assert "damper.start[0]" in refused(row, rb.replicas({"damper.start": "1 um"}, 3))


@pytest.mark.parametrize(
    "ends",
    [
        ("1 mm", "1 inch"),
        ("1 Hz", "10 rad/s"),
        ("1 Ns/m", "2 kg/s"),
        (-1, "1 mm"),
        ("-2 mm", (-1, "mm")),
        ("10 deg", "1 rad"),
    ],
    ids=str,
)
def test_ends_of_a_range_may_have_different_units(ends: tuple[Any, Any]) -> None:
    """The ends of a range may have different units of one dimension, or one may be a plain number in SI."""
    assert rb.linspace(*ends, 3).start == ends[0]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rb.linspace(0, 1, 0), "count = 0"),
        (lambda: rb.geomspace(1, 2, 2.5), "count = 2.5"),  # type: ignore[arg-type]
        (
            lambda: rb.geomspace("0 mm", "1 mm", 3),
            "start = '0 mm', stop = '1 mm': .* must not be zero",
        ),
        (lambda: rb.geomspace(-1, 2.0, 3), "start = -1, stop = 2.0: .* the same sign"),
        (lambda: rb.linspace("1 mm", "1 kN", 3), "start = '1 mm', stop = '1 kN': the dimensions of the ends differ"),
        (lambda: rb.linspace((1, "inch"), "1 kg", 3), "the dimensions of the ends differ"),
        (lambda: rb.linspace("1 mm", "2 mn", 3), "unknown unit 'mn'"),
        (lambda: rb.random_design({}, 3), "ranges"),
        (lambda: rb.random_design({"a": (0, 1)}, 3, method="sobl"), "did you mean 'sobol'"),  # type: ignore[arg-type]
        (lambda: rb.random_design({"a": (0, 1)}, 3, log="b"), "log = 'b'"),
        (lambda: rb.random_design({"a": (0, 1)}, 3, seed=-1), "seed = -1"),
        (lambda: rb.replicas("damper.start", 3), "reach"),  # type: ignore[arg-type]
        (lambda: rb.replicas({"a": 1}, True), "count = True"),
    ],
)
def test_bad_arguments_are_refused_at_once(make: Any, message: str) -> None:
    """Arguments that are wrong for any case are refused at construction."""
    with pytest.raises(rb.CaseError, match=message):
        make()


def test_cavities_and_bodies_are_labelled_by_their_sizes(boxed: rb.Case) -> None:
    """Shapes along an axis have short labels with units; no test had a cavity of triangles, labelled by all its corners."""
    corners = [[0, 0, 0], [300, 0, 0], [0, 250, 0], [0, 0, 200]]
    mesh = rb.Mesh(vertices=corners, faces=[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], unit="mm")
    cavities = [rb.Box(size=("120 mm", "120 mm", "90 mm")), rb.Cylinder(diameter="130 mm", length="90 mm"), mesh]
    bodies: list[Any] = [[], [rb.RodBody(diameter="20 mm")], []]
    coords = read_axes(boxed, {("damper.cavity", "damper.bodies"): (cavities, bodies)}).coords()
    labels = {name: values.tolist() for name, (_, values, _) in coords.items()}
    assert labels["damper.cavity"] == [
        "box of 120 x 120 x 90 mm",
        "cylinder, 130 mm in diameter, 90 mm long",
        "surface of 4 triangles, 300 x 250 x 200 mm",
    ]
    assert labels["damper.bodies"] == ["none", "rod, 20 mm in diameter", "none"]


def test_kinds_vary_as_whole_parts_only(boxed: rb.Case) -> None:
    """An axis of kinds advises to list whole parts, which works; it said that the second kind must be the first."""
    with pytest.raises(rb.CaseError, match=r'whole parts, \{"damper.cavity": \[...\]\}'):
        read_axes(boxed, {"damper.cavity.kind": ["box", "cylinder"]})


def test_labels_of_long_lists_are_short() -> None:
    """A list of many numbers is named by its first and last one, so that legends can be read; short ones were tested."""
    tower = rb.ShearBuilding(masses=["30 t"] * 9, stiffnesses=["50 MN/m"] * 9, damping_ratio=0.02)
    case = rb.Case(structure=tower, base=rb.HalfSine(amplitude="1 m/s^2", duration="0.2 s"), duration="1 s")
    lists = [[factor * 50e6] * 8 + [40e6] for factor in (0.9, 1.1)]
    study = rb.sweep(case, {"structure.stiffnesses": lists}, ["peak"], point="storey 9", progress=False)
    assert study["structure.stiffnesses"].values.tolist() == ["[4.5e+07, ..., 4e+07]", "[5.5e+07, ..., 4e+07]"]
