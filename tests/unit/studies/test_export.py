"""Results of studies and runs in files of other programs."""

import shutil
import subprocess

import numpy as np
import pytest
import xarray as xr
from scipy.io import loadmat

import rattlebox as rb


@pytest.fixture(scope="module")
def study():
    """Return a sweep over two linked numbers and two laws."""
    gaps = {("damper.gap", "damper.start"): [["0.1 mm", "0.2 mm", "0.3 mm"], [0.0, 0.1, 0.2]]}
    laws = {"damper.contact": [rb.Tsuji(alpha=0.1), rb.Tsuji(alpha=0.2)]}
    return rb.sweep(rb.reference_case(duration=0.1), gaps | laws, ["peak", "impacts"], progress=False)


def test_studies_in_matlab_files(study, tmp_path):
    """Variables, axes and units are in the file under names that MATLAB allows; vectors are columns, texts cells."""
    content = loadmat(rb.to_mat(study, tmp_path / "study.mat"))
    fields = content["study"][0, 0]
    assert set(fields.dtype.names) == {"status", "peak", "impacts", "damper_gap", "damper_start", "damper_contact"}
    np.testing.assert_array_equal(fields["peak"], study.peak.values)
    np.testing.assert_array_equal(fields["damper_gap"], [[1e-4], [2e-4], [3e-4]])
    assert [cell[0] for cell in fields["damper_contact"][:, 0]] == list(study["damper.contact"].values)
    assert [cell[0] for cell in content["dims"][0, 0]["peak"][:, 0]] == ["damper_gap", "damper_contact"]
    assert content["units"][0, 0]["peak"][0] == content["units"][0, 0]["damper_gap"][0] == "m"
    assert content["info"][0, 0]["case"][0] == study.attrs["case"]


def test_every_kind_of_result_is_written(tmp_path):
    """Attributes that are lists, flags, and case files are written, too."""
    case = rb.reference_case(duration=0.05)
    data = xr.Dataset(
        {"2nd value": ("x", [True, False])}, attrs={"warnings": ["one", "two"], "empty": [], "none": None}
    )
    content = loadmat(rb.to_mat(data, tmp_path / "data.mat"))
    assert content["study"][0, 0]["x2nd_value"].ravel().tolist() == [1, 0]
    assert [cell[0] for cell in content["info"][0, 0]["warnings"][:, 0]] == ["one", "two"]
    with pytest.raises(rb.CaseError, match=r"run\.to_mat"):
        rb.to_mat(rb.simulate(case), tmp_path / "run.mat")
    with pytest.raises(rb.DataError, match=r"study\.mat"):
        rb.to_mat(data, tmp_path / "study.nc")


def test_netcdf_of_a_study_reads_back(study, tmp_path):
    """A study that xarray writes to netCDF and reads is the same, with units."""
    study.to_netcdf(tmp_path / "study.nc")
    with xr.open_dataset(tmp_path / "study.nc") as again:
        xr.testing.assert_equal(again.load(), study)
        assert again.peak.attrs["units"] == "m"


@pytest.mark.skipif(shutil.which("octave") is None, reason="octave is not installed")
def test_octave_reads_both(study, tmp_path):
    """Octave loads the files of a study and of a run, and finds the same numbers."""
    rb.to_mat(study, tmp_path / "study.mat")
    run = rb.simulate(rb.reference_case(duration=0.05))
    run.to_mat(tmp_path / "run.mat")
    program = (
        "s = load('study.mat'); r = load('run.mat');"
        "printf('%.17g %.17g %s', s.study.peak(2, 1), max(abs(r.motion.displacement)), s.dims.peak{1})"
    )
    done = subprocess.run(["octave", "--eval", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    peak, largest, name = done.stdout.split()
    assert float(peak) == study.peak.values[1, 0]
    assert float(largest) == np.abs(run.arrays.displacement).max()
    assert name == "damper_gap"
