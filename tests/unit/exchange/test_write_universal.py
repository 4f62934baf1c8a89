"""Universal files that Rattlebox writes: read back by its own reader and by pyuff."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import rattlebox as rb
from rattlebox.exchange.read.universal import read_functions
from rattlebox.exchange.write.universal import Function, _number, function_set, write_universal

pyuff = pytest.importorskip("pyuff")


def sets(path: Path) -> list[dict[str, Any]]:
    """Return all sets as pyuff reads them."""
    return list(pyuff.UFF(str(path)).read_sets())


def run(**output: Any) -> rb.Run:
    """Return a short run of the reference case."""
    case = rb.reference_case(duration=0.2)
    return rb.simulate(case.model_copy(update={"output": rb.Output(**output)}) if output else case, progress=False)


def response() -> xarray.Dataset:
    """Return a transfer function with numbers of many digits."""
    time = np.arange(12_000) / 1500
    force = np.random.default_rng(3).normal(size=time.size)
    motion = np.convolve(force, [0.3, -0.7, 0.2], "same") / 3
    named = [xarray.DataArray(x, attrs={"units": unit}) for x, unit in ((force, "N"), (motion, "m/s^2"))]
    return rb.analysis.transfer_function(time, *named, resolution=1.5)


@pytest.mark.parametrize("output", [{}, {"rate": "3 kHz"}, {"times": [0.0, 0.001, 0.0505, 0.2]}])
def test_time_histories_read_back_to_the_last_bit(output: dict[str, Any], tmp_path: Path) -> None:
    """Values are equal to the last bit, times to a thousandth of a step; there was no writer before."""
    own = run(**output)
    file = own.to_uff(tmp_path / "run.uff")
    functions = {function.name: function for function in read_functions(file)}
    assert set(functions) > {"displacement mass", "absolute_acceleration mass", "base_acceleration", "load half_sine 1"}
    time = own.arrays.time
    for name in ("displacement", "velocity", "acceleration"):
        function = functions[f"{name} mass"]
        np.testing.assert_array_equal(function.values, getattr(own.arrays, name)[:, 0])
        assert np.abs(function.abscissa - time).max() <= 1e-3 * np.diff(time).min()
        assert function.unit == own.motion[name].attrs["units"]
    found = [each for each in sets(file) if each["type"] == 58]
    np.testing.assert_array_equal(found[0]["data"], own.arrays.displacement[:, 0])
    assert [each["func_type"] for each in found] == [1] * len(found)
    assert [each["ordinate_spec_data_type"] for each in found if each["id1"].startswith("load")] == [13]
    record = rb.Record.from_file(file, columns="load half_sine 1")
    np.testing.assert_array_equal(record.values, own.arrays.load[:, 0])


def test_variables_and_nodes(tmp_path: Path) -> None:
    """Chosen variables are written at the given nodes; unknown ones and shared nodes are refused."""
    own = run()
    file = own.to_uff(tmp_path / "run.uff", variables=["velocity"], nodes={"mass": "12 -y"})
    (only,) = (each for each in sets(file) if each["type"] == 58)
    assert (only["rsp_node"], only["rsp_dir"], only["ordinate_spec_data_type"]) == (12, -2, 11)
    for options, message in (
        ({"variables": ["speed"]}, "no time history 'speed'"),
        ({"nodes": {"tip": 3}}, "no point 'tip'"),
        ({"nodes": {"mass": "x 3"}}, "is not a node"),
    ):
        with pytest.raises(rb.DataError, match=message):
            own.to_uff(tmp_path / "other.uff", **options)
    assert not (tmp_path / "other.uff").exists()
    two = rb.Modal(frequencies=[3.0], damping_ratios=[0.0], shapes={"a": [1.0], "b": [2.0]})
    with pytest.raises(rb.DataError, match="both node 2"):
        rb.to_uff(two, tmp_path / "two.uff", nodes={"a": 2})


def test_loads_are_at_the_nodes_of_their_points(tmp_path: Path) -> None:
    """A load has the node of its point, on a line and in 3-D, against an axis and along none.

    All loads were at node 0: the tests read their values only.
    """
    line = rb.Case(
        structure=rb.ShearBuilding(masses=["2 t"] * 2, stiffnesses=["1 MN/m"] * 2),
        loads=[
            rb.Harmonic(amplitude="1 kN", frequency="2 Hz", point="storey 2"),
            rb.HalfSine(amplitude="1 kN", duration="0.1 s", point="storey 1"),
        ],
        duration="0.1 s",
    )
    spatial = rb.Case(
        structure=rb.Modal(frequencies=["40 Hz"], damping_ratios=[0.0], shapes={"tip": [[1.0, 0.5, 2.0]]}),
        loads=[
            rb.Harmonic(amplitude="1 N", frequency="9 Hz", direction=direction) for direction in ("z", "-y", (1, 1, 0))
        ],
        duration="0.1 s",
    )
    places = []
    for case, nodes in ((line, {"storey 1": "7 x", "storey 2": "9 -x"}), (spatial, {"tip": 8})):
        file = rb.simulate(case, progress=False).to_uff(
            tmp_path / f"{len(places)}.uff", variables=["load"], nodes=nodes
        )
        places.append([(each["rsp_node"], each["rsp_dir"]) for each in sets(file) if each["type"] == 58])
    assert places == [[(9, -1), (7, 1)], [(8, 3), (8, -2), (8, 0)]]


def test_a_run_in_three_dimensions(tmp_path: Path) -> None:
    """Components of vectors have the directions of their axes, and variables that a run cannot know are left out."""
    damper = rb.ParticleDamper(
        particles=rb.Particles(material="glass", diameter="4 mm", count=10),
        cavity=rb.Box(size=("20 mm", "20 mm", "20 mm")),
        contact=rb.Tsuji(restitution=0.8),
        softening=1000,
    )
    structure = rb.Modal(frequencies=["40 Hz"], damping_ratios=[0.0], shapes={"tip": [[1.0, 0.0, 2.0]]}, velocity=[0.2])
    own = rb.simulate(rb.Case(structure=structure, damper=damper, duration="5 ms"), progress=False)
    found = [each for each in sets(own.to_uff(tmp_path / "run.uff", nodes={"tip": 8})) if each["type"] == 58]
    places = {each["id1"]: (each["rsp_node"], each["rsp_dir"]) for each in found}
    assert [places[f"velocity tip {axis}"] for axis in "xyz"] == [(8, 1), (8, 2), (8, 3)]
    assert [places[f"base_acceleration {axis}"] for axis in "xyz"] == [(0, 1), (0, 2), (0, 3)]
    assert not any(name.startswith("interface_force") for name in places)


def test_response_functions_read_back_to_the_last_bit(tmp_path: Path) -> None:
    """A transfer function is read by `read_frequency_response` with its bits and unit, the coherence as type 6."""
    result = response()
    file = rb.to_uff({"tip": result}, tmp_path / "frf.uff", nodes={"tip": "21 z"})
    back = rb.analysis.read_frequency_response(file)
    np.testing.assert_array_equal(back.transfer.values, result.transfer.values)
    np.testing.assert_array_equal(back.frequency.values, result.frequency.values)
    assert back.transfer.attrs["units"] == "m/s^2/N"
    found = [each for each in sets(file) if each["type"] == 58]
    assert [each["func_type"] for each in found] == [4, 6, 0]
    assert {(each["rsp_node"], each["rsp_dir"]) for each in found} == {(21, 3)}
    np.testing.assert_array_equal(found[0]["data"], result.transfer.values)
    np.testing.assert_array_equal(found[1]["data"], result.coherence.values)
    assert (found[0]["ordinate_spec_data_type"], found[0]["orddenom_spec_data_type"]) == (12, 13)


def test_transmissibilities_and_densities(tmp_path: Path) -> None:
    """A transmissibility has type 5 and is read back, a density type 9."""
    time = np.arange(8000) / 1000
    base = xarray.DataArray(np.random.default_rng(1).normal(size=time.size), attrs={"units": "m/s^2"})
    ratio = rb.analysis.transmissibility(time, base, 2 * base, resolution=2.0)
    density = rb.analysis.power_spectral_density(time, base, resolution=2.0)
    file = rb.to_uff({"t": ratio, "g": density}, tmp_path / "both.unv")
    kinds = [each["func_type"] for each in sets(file) if each["type"] == 58]
    assert kinds[0] == 5 and 9 in kinds
    back = rb.analysis.read_frequency_response(file)
    np.testing.assert_array_equal(back.transfer.values, ratio.transfer.values)
    assert back.transfer.attrs["units"] == "1"
    level = rb.Random.from_file(file, "1 s", columns=["g density"])
    assert set(level.corners[:, 1]) <= set(density.density.values)
    assert level.unit == "m/s^2"


def test_a_frequency_response_is_a_response_function(tmp_path: Path) -> None:
    """Amplitude and phase over the load are 1 / (k - m w^2 + i w c) of a linear structure; lost points are left out."""
    ball = rb.Sphere(radius="1 mm", material="steel")
    case = rb.Case(
        structure=rb.SDOF(mass="2 kg", frequency="11 Hz", damping_ratio="4 %"),
        load=rb.Harmonic(amplitude="3 N", frequency="9 Hz"),
        duration="1 s",
        damper=rb.ImpactDamper(ball=ball, gap="1 m", contact=rb.Tsuji(restitution=0.9)),
    )
    found = rb.frequency_response(case, ["9 Hz", "11 Hz", "12 Hz", "14.5 Hz"], direction="up", progress=False)
    found.amplitude[..., 2] = np.nan
    file = rb.to_uff(found, tmp_path / "response.uff")
    (only,) = (each for each in sets(file) if each["type"] == 58)
    w = 2 * np.pi * np.array([9.0, 11.0, 14.5])
    w0 = 2 * np.pi * 11.0
    np.testing.assert_array_equal(only["x"], [9.0, 11.0, 14.5])
    np.testing.assert_allclose(only["data"], 1 / (2 * (w0**2 - w**2 + 2j * 0.04 * w0 * w)), rtol=2e-4)
    assert (only["ordinate_axis_units_lab"], only["orddenom_axis_units_lab"]) == ("m", "N")
    assert "3 N" in only["id1"]


def test_modes_read_back(tmp_path: Path) -> None:
    """Modes of points along lines and in 3-D are read with seven digits, with nodes, positions and SI units."""
    generator = np.random.default_rng(5)
    structure = rb.Modal(
        frequencies=[7.123456789, 123.456789012, 4567.89],
        damping_ratios=[0.0123456789, 0.002, 0.03],
        shapes={"tip": generator.normal(size=3).tolist(), "body": generator.normal(size=(3, 3)).tolist()},
    )
    place = {"tip": (0.5, 0.0, 1 / 3), "body": (1.0, 2.0, 3.0)}
    file = rb.to_uff(structure, tmp_path / "modes.uff", nodes={"tip": "21 -y", "body": 4}, positions=place)
    back = rb.Modal.from_file(file, points={"tip": "21 y", "body": 4})
    own, other = structure.modes(), back.modes()
    np.testing.assert_allclose(other.stiffness, own.stiffness, rtol=1e-8)
    np.testing.assert_allclose(other.decay, own.decay, rtol=1e-7)
    np.testing.assert_allclose(other.shapes["body"], own.shapes["body"], rtol=1e-6)
    np.testing.assert_allclose(other.shapes["tip"], -own.shapes["tip"], rtol=1e-6)
    (nodes,) = (each for each in sets(file) if each["type"] == 2411)
    assert (list(nodes["node_nums"]), list(nodes["z"])) == ([21, 4], [1 / 3, 3.0])
    (units,) = (each for each in sets(file) if each["type"] == 164)
    assert (units["length"], units["force"]) == (1.0, 1.0)


def test_coupled_damping_is_stated(tmp_path: Path) -> None:
    """Modes that the damping couples are written with a warning that only the ratios are."""
    damping, stiffness = [[3.0, 0.0], [0.0, 0.0]], [[300.0, -100.0], [-100.0, 200.0]]
    structure = rb.Matrices(M=np.eye(2), C=damping, K=stiffness, points={"a": 0, "b": 1})
    with pytest.warns(UserWarning, match="couples modes"):
        rb.to_uff(structure, tmp_path / "modes.uff")


def test_no_other_file_is_replaced(tmp_path: Path) -> None:
    """Own files are replaced; a file of another program, or one that has changed, is not."""
    file = tmp_path / "modes.uff"
    structure = rb.SDOF(mass=1.0, frequency="5 Hz")
    rb.to_uff(structure, file)
    rb.to_uff(rb.SDOF(mass=2.0, frequency="6 Hz"), file)
    content = file.read_bytes()
    file.write_bytes(content.replace(b"6 Hz", b"7 Hz"))
    with pytest.raises(rb.DataError, match="not overwritten"):
        rb.to_uff(structure, file)
    pyuff.UFF(str(tmp_path / "theirs.uff")).write_sets(
        {"type": 58, "func_type": 1, "rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1, "x": np.arange(3.0),
         "data": np.arange(3.0), "orddenom_spec_data_type": 0}
    )  # fmt: skip
    with pytest.raises(rb.DataError, match="not overwritten"):
        run().to_uff(tmp_path / "theirs.uff")
    with pytest.raises(rb.DataError, match=r"not a \.nc file"):
        rb.to_uff(structure, tmp_path / "modes.nc")


def test_other_sources_are_refused(tmp_path: Path) -> None:
    """Sources that have neither modes nor functions are refused in words."""
    for source in (3, "text", {"a": 1}):
        with pytest.raises(rb.CaseError, match="cannot be written"):
            rb.to_uff(source, tmp_path / "a.uff")
    with pytest.raises(rb.DataError, match="no function of the frequency"):
        rb.to_uff(xarray.Dataset({"a": ("time", [1.0, 2.0])}), tmp_path / "a.uff")
    with pytest.raises(rb.CaseError, match="no modes"):
        rb.to_uff(rb.Fixed(), tmp_path / "a.uff")


def test_numbers_fit_into_their_columns() -> None:
    """Numbers of all sizes have 13 characters and at least five digits; short ones keep all of them."""
    generator = np.random.default_rng(2)
    for value in [*(generator.normal(size=200) * 10.0 ** generator.integers(-90, 90, 200)), 0.1, 1e-4, -2.5e30, 0.0]:
        text = _number(float(value))
        assert len(text) == 13 and text[0] == " " and "." in text
        assert float(text) == pytest.approx(value, rel=1e-5, abs=0)
    assert float(_number(1 / 3000)) == pytest.approx(1 / 3000, rel=2e-8)


def test_uneven_points_and_empty_functions(tmp_path: Path) -> None:
    """Uneven points are stored as doubles, to the last bit; fewer than two points are refused."""
    x = np.sort(np.random.default_rng(4).uniform(0, 1, 20))
    values = np.exp(7j * x) / 3
    file = write_universal(tmp_path / "one.uff", [function_set(Function("f", 4, x, "Hz", values, "m", "N"))])
    (only,) = read_functions(file)
    np.testing.assert_array_equal(only.abscissa, x)
    np.testing.assert_array_equal(only.values, values)
    with pytest.raises(rb.DataError, match="two or more"):
        function_set(Function("f", 4, x[:1], "Hz", values[:1], "m"))
