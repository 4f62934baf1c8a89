"""Example runs for the tests of results."""

from support.run_fixtures import any_run, make_run, run, two_dampers

__all__ = ["any_run", "make_run", "run", "two_dampers"]
