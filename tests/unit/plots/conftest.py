"""The runs of the tests of results serve the figures too."""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

_spec = spec_from_file_location("results_runs", Path(__file__).parents[1] / "results" / "conftest.py")
assert _spec is not None
assert _spec.loader is not None
_module = module_from_spec(_spec)
_spec.loader.exec_module(_module)

make_run, any_run, run, two_dampers = _module.make_run, _module.any_run, _module.run, _module.two_dampers
