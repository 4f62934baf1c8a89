"""Branches of periodic motions: arguments, files, words and figures."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.kinds import study_kind
from rattlebox.studies.orbits.branch_words import stretches
from rattlebox.studies.run.study import make_study


@pytest.fixture(scope="module")
def orbit():
    """Return a symmetric motion with two impacts a cycle."""
    return rb.find_orbit(
        rb.Case(
            structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
            damper=rb.ImpactDamper(
                ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
            ),
            load=rb.Harmonic(amplitude="5 N", frequency="33 Hz"),
            method=rb.Newton(),
            duration="2 s",
        )
    )


@pytest.fixture(scope="module")
def branch(orbit):
    """Return a branch over the frequency with a pitchfork and a torus."""
    return rb.continue_orbit(orbit, "load.frequency", ("31 Hz", "38 Hz"), progress=False)


WRONG = {
    "a phase": ("load.phase", (0.0, 1.0), "only shifts"),
    "a duration": ("duration", (1.0, 3.0), "no effect"),
    "a start": ("damper.start", (-0.5, 0.5), "not a number|no effect"),
    "a name": ("name", (0.0, 1.0), "not a number"),
    "no such path": ("damper.gapp", (0.0, 1.0), "no 'gapp'"),
    "limits in the wrong order": ("load.frequency", ("38 Hz", "31 Hz"), "smaller one"),
    "limits elsewhere": ("load.frequency", ("50 Hz", "60 Hz"), "not between the limits"),
    "an invalid limit": ("damper.gap", (-1e-3, 2e-3), "gap"),
    "one limit": ("load.frequency", ("38 Hz",), "smallest and the largest"),
    "a number as limits": ("load.frequency", 38.0, "smallest and the largest"),
    "not a path": (3, (0.0, 1.0), "not a path"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_arguments(orbit, name):
    """A parameter or limits that cannot be used are refused with the reason."""
    axis, limits, words = WRONG[name]
    with pytest.raises(rb.CaseError, match=words):
        rb.continue_orbit(orbit, axis, limits, progress=False)


def test_not_a_motion():
    """A run in place of a motion is refused with the function that finds one."""
    with pytest.raises(rb.CaseError, match="not a periodic motion") as raised:
        rb.continue_orbit("run", "load.frequency", ("31 Hz", "38 Hz"))
    assert "find_orbit" in raised.value.suggestion


@pytest.mark.parametrize("near", ["a", 3.0, [[1.0, 2.0], [3.0, 4.0]], ["a", "b"], [np.nan, 1.0, 1.0, 1.0], {"x": 1}])
def test_wrong_states(orbit, near):
    """What is no run, motion or state is refused as the start of a search, in Python and before a study runs."""
    with pytest.raises(rb.RattleboxError, match=r"is not a run|no file"):
        study_from_case(orbit.case, near).validate()
    if near != "a":
        with pytest.raises(rb.CaseError, match="is not a run"):
            rb.find_orbit(orbit.case, near=near)


def study_from_case(case, near):
    """Return a study of a branch that begins near something."""
    return make_study(
        study_kind("continue_orbit"),
        {"case": case, "axis": "load.frequency", "limits": ["31 Hz", "38 Hz"], "near": near},
    )


def test_points_and_words(branch):
    """The points go from limit to limit, and the text names the special points."""
    values = branch.data.value.values
    assert sorted((values[0], values[-1])) == pytest.approx([31.0, 38.0])
    assert [point.kind for point in branch.specials] == ["pitchfork", "torus"]
    for words in ("load.frequency", "pitchfork", "Neimark-Sacker", "stable"):
        assert words in str(branch)


def test_orbit_of_a_point(branch):
    """The motion of a point is computed again with the same multipliers."""
    for index in (0, 5, len(branch) // 2, -1):
        row, orbit = branch.data.isel(point=index), branch.orbit(index)
        assert orbit.amplitudes["mass"] == pytest.approx(float(row.amplitude[0]), rel=1e-9)
        np.testing.assert_allclose(np.abs(orbit.multipliers[0]), np.hypot(*row_multipliers(row)), rtol=1e-7)
    with pytest.raises(rb.CaseError, match="no point"):
        branch.orbit(len(branch))


def row_multipliers(row):
    """Return real and imaginary part of the largest multiplier."""
    return float(row.multiplier_real[0]), float(row.multiplier_imaginary[0])


def test_file(branch, tmp_path):
    """A branch that is read from its file is the same, and other files are refused."""
    again = rb.Branch.load(branch.save(tmp_path / "branch.nc"))
    assert again.parameter == branch.parameter
    for name in branch.data:
        np.testing.assert_array_equal(again.data[name].values, branch.data[name].values)
    assert str(again) == str(branch)
    (tmp_path / "other.nc").write_bytes(b"nothing")
    with pytest.raises(rb.DataError, match="cannot be read"):
        rb.Branch.load(tmp_path / "other.nc")
    with pytest.raises(rb.DataError, match="no file"):
        rb.Branch.load(tmp_path / "missing.nc")


def test_flipped_bits_of_a_file(branch, tmp_path):
    """A flipped bit in the file of a branch is an error, or changes nothing: files of branches had no digest."""
    file = branch.save(tmp_path / "branch.nc")
    content, random = file.read_bytes(), np.random.default_rng(5)
    whole, damaged = rb.Branch.load(file).data, 0
    for place, bit in zip(random.integers(0, len(content), 60), random.integers(0, 8, 60), strict=True):
        changed = bytearray(content)
        changed[place] ^= 1 << bit
        file.write_bytes(changed)
        try:
            assert rb.Branch.load(file).data.identical(whole)
        except rb.DataError:
            damaged += 1
    assert damaged > 20


def test_branch_of_motions_without_symmetry(branch):
    """At the pitchfork a branch of motions begins that are not symmetric; at a torus none is computed."""
    pitchfork, torus = branch.specials
    other = branch.switch(pitchfork, ("31 Hz", "33 Hz"), points=5, progress=False)
    assert not other.data.symmetric.values.astype(bool)[2:].any()
    with pytest.raises(rb.CaseError, match="flip or a pitchfork"):
        branch.switch(torus)


def test_progress_stops(orbit):
    """The continuation ends with the points so far if the function of the progress returns False."""
    branch = rb.continue_orbit(orbit, "load.frequency", ("31 Hz", "38 Hz"), progress=lambda done, _: done < 4)
    assert 1 <= len(branch) < 12
    assert branch.data.attrs["ended"].endswith("the continuation was stopped")


def test_progress_stops_a_curve(branch):
    """A curve in two parameters ends on both sides when the progress returns False once, and states it.

    It stated no reason and followed the other side; tests stopped branches only.
    """
    answers, axes = iter([True, True, False]), ("load.frequency", "damper.gap")
    curve = rb.continue_point(
        branch.specials[0], axes, [("28 Hz", "36 Hz"), (0.7e-3, 1.3e-3)], progress=lambda *_: next(answers, True)
    )
    assert curve.sizes["point"] < 5
    assert curve.attrs["ended"].count("the continuation was stopped") == 2


def test_phases_between_loads(orbit):
    """With two loads, the message about a phase does not state that it has no effect.

    The test of phases had one load.
    """
    loads = [rb.Harmonic(amplitude="5 N", frequency="33 Hz"), rb.Harmonic(amplitude="1 N", frequency="33 Hz")]
    both = rb.find_orbit(orbit.case.model_copy(update={"loads": tuple(loads)}), period=1)
    with pytest.raises(rb.CaseError, match="one of 2 loads, cannot be followed"):
        rb.continue_orbit(both, "load[1].phase", (-0.5, 0.5), progress=False)


def test_a_closed_branch_has_no_first_stretch(branch):
    """The stretch that contains the first point of a closed branch is one, from special point to special point.

    It was stated as two stretches that overlap; no test looked at the stretches of a closed branch.
    """
    ends = [each.limits for each in stretches(branch.data)]
    assert ends == [("", "pitchfork"), ("pitchfork", "torus"), ("torus", "")]
    joined, stable = stretches(branch.data.assign_attrs(closed=1))
    assert (joined.limits, stable.limits) == (("torus", "pitchfork"), ("pitchfork", "torus"))
    assert sorted([*joined.rows, *stable.rows]) == np.flatnonzero(branch.data.special.values == "").tolist()
    assert (joined.low, joined.high) == (branch.data.value.values.min(), branch.data.value.values.max())


def test_figure(branch):
    """The figure has lines for stable and unstable motions and marks of the special points."""
    figure = branch.plot()
    names = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert {"stable", "unstable", "pitchfork", "Neimark-Sacker"} <= set(names)


def test_figure_of_a_shaken_cavity():
    """Without a structure that responds, the figure shows approach speeds: it was a line at an amplitude of zero.

    No figure of a test had a prescribed motion.
    """
    case = rb.Case(
        structure=rb.Shaker(motion=rb.Harmonic(amplitude="1.4 mm", frequency="17 Hz")),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="9 mm", material="steel"), gap="1.1 mm", contact=rb.Tsuji(restitution=0.55)
        ),
        method=rb.Newton(),
        duration="3 s",
    )
    limits = ("1.38 mm", "1.5 mm")
    branch = rb.continue_orbit(rb.find_orbit(case), "structure.motion.amplitude", limits, progress=False)
    (axes,) = branch.plot().axes
    assert axes.get_ylabel().replace("\n", " ") == "Smallest approach speed (mm/s)"
    assert max(line.get_ydata()[0] for line in axes.lines if len(line.get_ydata())) > 10
    assert "5 impacts in 2 cycles" in str(branch)


def test_same_branch_over_a_linked_parameter(orbit):
    """The motion at another restitution is on the branch over the restitution."""
    branch = rb.continue_orbit(orbit, "damper.contact.restitution", (0.55, 0.65), progress=False)
    end = branch.orbit(-1)
    again = rb.find_orbit(end.case, near=end)
    assert again.amplitudes["mass"] == pytest.approx(end.amplitudes["mass"], rel=1e-9)


def same(one, other):
    """Return whether two branches have the same points bit by bit."""
    return all(
        np.array_equal(one.data[name].values, other.data[name].values, equal_nan=one.data[name].dtype.kind == "f")
        for name in other.data
    )


@pytest.mark.parametrize("stop", [1, 10, 30])
def test_resume(orbit, tmp_path, stop):
    """A branch that was stopped on either side resumes from its file with the same bits; a complete branch is read."""
    file, limits = tmp_path / "branch.nc", ("31 Hz", "35 Hz")
    whole = rb.continue_orbit(orbit, "load.frequency", limits, progress=False)
    part = rb.continue_orbit(orbit, "load.frequency", limits, store=file, progress=lambda done, _: done < stop)
    assert len(part) < len(whole)
    again = rb.continue_orbit(orbit, "load.frequency", limits, store=file, progress=False)
    assert same(again, whole) and str(again) == str(whole)
    read = rb.continue_orbit(orbit, "load.frequency", limits, store=file, progress=lambda *_: pytest.fail("computed"))
    assert same(read, again)
    with pytest.raises(rb.DataError, match="another motion"):
        rb.continue_orbit(orbit, "load.frequency", ("31 Hz", "36 Hz"), store=file, progress=False)


@pytest.mark.parametrize("stop", [74, pytest.param(150, marks=pytest.mark.slow)])
def test_resume_of_a_closed_branch(orbit, tmp_path, stop):
    """A closed branch that was stopped closes at its start: it went around a second time, to where it had been resumed.

    Resumed branches of the tests had two ends.
    """
    state = [-2.778e-3, -0.2005, -3.195e-3, -0.6344]
    start = rb.find_orbit(orbit.case.replaced({"load.frequency": "30.5 Hz"}), near=state, period=1)
    limits, file = ("24 Hz", "42 Hz"), tmp_path / "branch.nc"
    whole = rb.continue_orbit(start, "load.frequency", limits, progress=False)
    assert whole.is_closed and len(whole) > stop
    rb.continue_orbit(start, "load.frequency", limits, store=file, progress=lambda done, _: done < stop)
    again = rb.continue_orbit(start, "load.frequency", limits, store=file, progress=False)
    assert again.is_closed and same(again, whole)


@pytest.mark.parametrize("most", [70, pytest.param(110, marks=pytest.mark.slow)])
def test_closed_branch_from_both_sides(orbit, tmp_path, most):
    """A closed branch on which one side ended at the number of points had parts of it twice, also special points.

    All closed branches of the tests had more points than the way around on the first side.
    """
    state, limits = [-2.778e-3, -0.2005, -3.195e-3, -0.6344], ("24 Hz", "42 Hz")
    start = rb.find_orbit(orbit.case.replaced({"load.frequency": "30.5 Hz"}), near=state, period=1)
    options = {"step": 0.05, "progress": False}
    whole = rb.continue_orbit(start, "load.frequency", limits, **options)
    branch = rb.continue_orbit(start, "load.frequency", limits, points=most, **options)
    assert branch.is_closed and not branch.data.attrs["ended"]
    assert sorted(point.kind for point in branch.specials) == sorted(point.kind for point in whole.specials)
    assert len(branch) < 1.1 * len(whole)
    file, most_done = tmp_path / "branch.nc", most + 20
    stopped = options | {"progress": lambda done, _: done < most_done}
    rb.continue_orbit(start, "load.frequency", limits, points=most, store=file, **stopped)
    again = rb.continue_orbit(start, "load.frequency", limits, points=most, store=file, **options)
    assert again.is_closed and same(again, branch)


def test_files_keep_the_passage_at_a_grazing(tmp_path):
    """How the branch continues at a grazing is in its file, in its special points and in its text."""
    case = rb.Case(
        structure=rb.SDOF(mass=1.0, stiffness=1.0, damping_ratio=0.05),
        stop=rb.Stop(gap=2.0, contact=rb.Linear(stiffness=1.0, restitution=0.5)),
        load=rb.Harmonic(amplitude=1.0, frequency="1.3 rad/s"),
        duration=200.0,
        method=rb.Newton(restitution=0.5),
    )
    orbit = rb.find_orbit(case, near=[0.1, 0.0], period=1)
    branch = rb.continue_orbit(orbit, "stop.gap", (1.2, 2.2), points=40, progress=False)
    again = rb.Branch.load(branch.save(tmp_path / "branch.nc"))
    passages = [point.passage for point in again.specials if point.kind == "grazing"]
    assert len(passages) == 1
    assert passages[0].endswith("with 1 impact")
    assert passages[0] in str(again)
    assert passages[0] in str(again.specials[0])
