"""Numbers with meanings in results of studies: flags as the CF conventions have them, in memory, Zarr and netCDF."""

from __future__ import annotations

from pathlib import Path

import h5netcdf  # type: ignore[import-untyped]
import numpy as np

import rattlebox as rb


def test_flags_have_values_of_the_type_of_their_variable(tmp_path: Path) -> None:
    """The status had meanings without values, so that readers could not tell which number is which."""
    case = rb.reference_case(duration=0.05)
    in_memory = rb.sweep(case, {"damper.gap": ["0.2 mm", "0.4 mm"]}, "peak", progress=False)
    rb.sweep(case, {"damper.gap": ["0.2 mm", "0.4 mm"]}, "peak", store=tmp_path / "store", progress=False)
    stored = rb.open_study(tmp_path / "store")
    for study in (in_memory, stored):
        about = study.status.attrs
        names = about["flag_meanings"].split()
        assert about["flag_values"].dtype == study.status.dtype
        assert about["flag_values"].tolist() == list(range(len(names)))
        assert names[about["flag_values"].tolist().index(int(study.status[0]))] == "finished"
    stored.load().to_netcdf(tmp_path / "study.nc", engine="h5netcdf")
    with h5netcdf.File(tmp_path / "study.nc") as file:
        status = file["status"]
        assert np.asarray(status.attrs["flag_values"]).dtype == status.dtype


def test_kinds_of_motion_and_attractors(tmp_path: Path) -> None:
    """Kinds of motions have values and meanings, in the result and in its store."""
    case = rb.Case(
        structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
        damper=rb.ImpactDamper(
            ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
        ),
        load=rb.Harmonic(amplitude="10 N", frequency="30 Hz"),
        duration="1 s",
    )
    found = rb.frequency_response(case, ["30 Hz", "31 Hz"], cycles=(20, 16), store=tmp_path / "store", progress=False)
    for study in (found, rb.open_study(tmp_path / "store")):
        for variable in study.variables.values():
            if "flag_meanings" in variable.attrs:
                flags = [variable.attrs[name] for name in ("flag_values", "flag_masks") if name in variable.attrs]
                assert [each.dtype for each in flags] == [variable.dtype]
                assert flags[0].size == len(variable.attrs["flag_meanings"].split())
        assert {"status", "motion"} <= {str(n) for n, v in study.variables.items() if "flag_values" in v.attrs}
