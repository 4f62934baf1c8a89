"""The source distribution."""

import hashlib
import os
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).parents[2]


def build(folder: Path) -> Path:
    """Build a source distribution and return the archive."""
    command = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}
    subprocess.run(
        [sys.executable, "-c", command, str(folder)], cwd=ROOT, env=environment, check=True, capture_output=True
    )
    (archive,) = folder.glob("*.tar.gz")
    return archive


def test_source_distribution_is_reproducible(tmp_path: Path) -> None:
    """Two builds have the same bits, with the core and the reproduction but no compiled file."""
    first, second = (build(tmp_path / name) for name in ("first", "second"))
    assert hashlib.sha256(first.read_bytes()).digest() == hashlib.sha256(second.read_bytes()).digest()
    with tarfile.open(first) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {"CMakeLists.txt", "core/dem/simulation.hpp", "reproduction/report.py", "tests/portable/cases.cpp"} <= names
    assert not [name for name in names if name.endswith((".so", ".o")) or name.startswith((".venv", "build/"))]
