"""Runs of figures as case and study files."""

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.studies.grid.axes import read_axes
from rattlebox.studies.study_file import read_study
from reproduction.files import grouped, record_cases, simulate, write_runs
from reproduction.system import PLASTIC, paper_case


def stated(case):
    """Return all fields of a case except its name."""
    return case.model_dump_json(exclude={"name"})


def read(folder, files):
    """Return all cases of the files."""
    for each in files.values():
        yield rb.Case.from_file(folder / each.case)
        if each.study:
            study = read_study(folder / each.study)
            design = read_axes(study.case, study.axes)
            assert design.size == each.runs
            yield from (design.case_at(study.case, number) for number in range(design.size))


def test_files_contain_every_run_of_a_figure(every, tmp_path):
    """Case and study files contain exactly the runs behind the data and the named cases."""
    (tmp_path / "cases").mkdir()
    named = every.figure.cases()
    written = [stated(case) for case in read(tmp_path, write_runs(named, every.runs, tmp_path, "cases", every.module))]
    assert len(set(written)) == len(written)
    assert set(written) == {stated(case) for case in every.runs} | {stated(case) for case in named.values()}


def test_a_run_belongs_to_the_nearest_case():
    """The nearest case has the fewest differences, then the smallest ones; repeated and named runs are not listed."""
    named = {"centred": paper_case(), "wall": paper_case(start=1.0), "plastic": paper_case(PLASTIC)}
    runs = [paper_case(start=0.9), paper_case(start=0.9), paper_case(start=0.1, amplitude=100.0), paper_case(PLASTIC)]
    assert grouped(named, runs) == {
        "wall": {"damper.start": [0.9]},
        "centred": {"damper.start": [0.1], "load.amplitude": [100.0]},
    }


def test_equal_runs_are_listed_once():
    """Equal runs are listed once, also if one has numbers of NumPy; only plain numbers were tested."""
    runs = [paper_case(duration=9.0), paper_case().model_copy(update={"duration": np.float64(9.0)})]
    assert grouped({"centred": paper_case()}, runs) == {"centred": {"duration": [9.0]}}


def test_run_that_is_no_variant():
    """A run with another law or other output times than all named cases raises an error."""
    with pytest.raises(ValueError, match="in more than numbers"):
        grouped({"constant": paper_case()}, [paper_case(PLASTIC)])
    with pytest.raises(ValueError, match="in more than numbers"):
        grouped({"constant": paper_case()}, [paper_case(times=[0.0])])


def test_recording_of_cases():
    """Only cases that run inside the context are recorded."""
    case = paper_case(duration=1e-3)
    simulate(case)
    with record_cases() as runs:
        simulate(case)
    simulate(case)
    assert runs == [case]


def test_a_study_of_a_figure_runs_by_itself(tmp_path):
    """A sweep of the study file has the numbers of the recorded runs."""
    (tmp_path / "cases").mkdir()
    runs = [paper_case(start=start, duration=0.5) for start in (0.2, 0.4)]
    named = {"Centred, 5 kN": paper_case(duration=0.5)}
    files = write_runs(named, runs, tmp_path, "cases", "figure_99")["Centred, 5 kN"]
    assert files.study == "cases/figure_99_centred_5_kn_study.toml" and files.varied == ("damper.start",)
    study = read_study(tmp_path / files.study)
    result = study.run()
    assert result.impacts.values.tolist() == [simulate(case).impacts.sizes["impact"] for case in runs]
