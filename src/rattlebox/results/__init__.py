"""What comes back: runs, impacts, the energy ledger, and their files."""

from .arrays import ImpactArrays, RunArrays
from .granular import GranularArrays, GranularLedger, GranularRun
from .ledger import Ledger
from .netcdf import load
from .provenance import Provenance
from .run import Run
from .summary import Comparison, Summary, compare

__all__ = [
    "Comparison",
    "GranularArrays",
    "GranularLedger",
    "GranularRun",
    "ImpactArrays",
    "Ledger",
    "Provenance",
    "Run",
    "RunArrays",
    "Summary",
    "compare",
    "load",
]
