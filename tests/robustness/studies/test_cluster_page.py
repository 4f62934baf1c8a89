"""The examples of the page on clusters."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rattlebox.core.choose import choice
from rattlebox.studies.run.stored import open_study
from rattlebox.studies.study_file import study_from_toml

ROOT = Path(__file__).parents[3]


def block(language: str, number: int = 0) -> str:
    """Return a code block of the page by its language."""
    result = re.findall(rf"```{language}\n(.*?)```", (ROOT / "docs" / "how-to" / "cluster.md").read_text(), re.DOTALL)
    assert len(result) == {"toml": 2}.get(language, 1)
    return str(result[number])


def test_the_study_file() -> None:
    """The study file is read, with its axes in the order of the lines."""
    study = study_from_toml(block("toml"), folder=ROOT / "examples")
    assert list(study.axes) == ["damper.gap", "load.amplitude"]


def test_the_map(tmp_path: Path) -> None:
    """The study file of another kind runs, with fewer values."""
    study = study_from_toml(block("toml", 1).replace("count = 41", "count = 5"), folder=ROOT / "examples")
    result = study.run(store=tmp_path / "study.zarr", progress=False)
    assert result.sizes["structure.motion.amplitude"] == 5
    assert not result.status.any()


@pytest.mark.slow
def test_the_python_script(tmp_path: Path) -> None:
    """The script runs unchanged and leaves a finished store."""
    (tmp_path / "script.py").write_text(block("python"))
    done = subprocess.run(
        [sys.executable, "-W", "error", "script.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "impact_share" in done.stdout
    assert open_study(tmp_path / "study.zarr").impact_share.notnull().all()


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
@pytest.mark.slow
def test_the_job_script(tmp_path: Path) -> None:
    """The job script, with a stand-in for srun and on the loopback, runs the study and ends its processes."""
    programs = tmp_path / ".venv" / "bin"
    programs.mkdir(parents=True)
    (programs / "activate").write_text(f"PATH={programs}:{Path(sys.executable).parent}:$PATH\n")
    (programs / "srun").write_text('#!/bin/sh\nexec "$@"\n')
    (programs / "srun").chmod(0o755)
    shutil.copy(ROOT / "examples" / "steel_ball.toml", tmp_path)
    (tmp_path / "study.toml").write_text(block("toml").replace("count = 200", "count = 2").replace("100 }", "3 }"))
    script = block("bash").replace("--no-dashboard", "--no-dashboard --dashboard-address 127.0.0.1:0 --host 127.0.0.1")
    script = script.replace("SIMD=v3", f"SIMD={choice()[0]}")
    process = subprocess.Popen(
        ["bash", "-c", script], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    output, message = process.communicate(timeout=60)  # until all of its processes have closed the pipes
    assert output.endswith("6 variants: 6 finished\nwritten to study.zarr\n"), message
    assert open_study(tmp_path / "study.zarr").impacts.shape == (2, 3)
