"""Runs and their files: arrays, datasets, energy ledger, summary."""

from .arrays import RunArrays, Table
from .ledger import Ledger
from .provenance import Provenance
from .run import Run, load
from .summary import Comparison, Summary, compare

__all__ = ["Comparison", "Ledger", "Provenance", "Run", "RunArrays", "Summary", "Table", "compare", "load"]
