"""Benchmark of the time that `import rattlebox` takes after NumPy: `python benchmarks/imports.py` prints one JSON line."""

from __future__ import annotations

import json
import subprocess
import sys
from statistics import median

REPEAT = 15
CODE = "from time import perf_counter as t; import numpy; a = t(); import rattlebox; print(t() - a)"


def main() -> None:
    """Measure in new processes, after one that fills the file cache, and print."""
    runs = [float(subprocess.check_output([sys.executable, "-c", CODE])) for _ in range(REPEAT + 1)][1:]
    print(json.dumps({"name": "import rattlebox after numpy", "seconds": min(runs), "median": median(runs)}))


if __name__ == "__main__":
    main()
