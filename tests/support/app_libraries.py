"""Libraries of the processes of the browser application, imported before these are forked. No thread is started."""

import h5netcdf  # noqa: F401
import pandas  # noqa: F401
import xarray

import rattlebox as rb
import rattlebox.analysis
import rattlebox.engines.simulate
import rattlebox.results.summary
from rattlebox.app import worker

xarray.DataArray([0.0, 1.0]).mean()  # imports the rest of xarray
rb.Case.from_toml(worker.template("steel_ball"))
worker.FIRST_LOOK = 0.1  # an early checkpoint, so that short runs have one
