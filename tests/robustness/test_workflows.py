"""Workflows of GitHub, which do not run here: they are well formed, and agree with pyproject.toml and the Makefile."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def read(path: Path) -> dict[str, Any]:
    """Return a workflow; the key `on` is the boolean True in YAML 1.1."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    return {"on" if key is True else key: value for key, value in content.items()}


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_have_steps_with_versions(path: Path) -> None:
    """Every job has a machine and steps, or calls a workflow that exists; actions are commits, commands of make exist."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    workflow = read(path)
    assert workflow["on"]
    assert workflow["permissions"]["contents"] == "read"
    for job in workflow["jobs"].values():
        assert set(job.get("needs", "").split()) <= set(workflow["jobs"])
        if "uses" in job:
            assert (ROOT / job["uses"]).is_file()
            continue
        assert job["runs-on"]
        for step in job["steps"]:
            assert ("uses" in step) != ("run" in step)
            if "uses" in step:
                # A commit cannot be moved to other code, as a tag can.
                assert re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40}|pypa/gh-action-pypi-publish@release/v1", step["uses"])
            for target in re.findall(r"make (\w+)", step.get("run", "")):
                assert re.search(rf"^{target}:", makefile, re.MULTILINE)


def test_wheels_serve_every_python() -> None:
    """Each Python of the classifiers has a wheel: those before the stable ABI one of their own, the others one in common."""
    named = [line.rpartition(" ")[2] for line in SETTINGS["project"]["classifiers"] if re.search(r":: 3\.\d+$", line)]
    stable = SETTINGS["tool"]["scikit-build"]["wheel"]["py-api"]
    versions = [f"cp{version.replace('.', '')}" for version in named]
    built = [name.removesuffix("-*") for name in SETTINGS["tool"]["cibuildwheel"]["build"]]
    assert f"cp{SETTINGS['project']['requires-python'].removeprefix('>=').replace('.', '')}" == built[0]
    assert built == [version for version in versions if version <= stable]
    for source in SETTINGS["tool"]["cibuildwheel"]["test-sources"]:
        assert (ROOT / source).is_file()


def test_releases_publish_without_a_token() -> None:
    """A tag starts the release; it needs the wheels and has the right to identify itself, and no secret."""
    path = ROOT / ".github" / "workflows" / "release.yml"
    release = read(path)
    assert list(release["on"]["push"]) == ["tags"]
    publish = release["jobs"]["publish"]
    assert publish["permissions"] == {"id-token": "write"}
    assert release["jobs"][publish["needs"]]["uses"] == "./.github/workflows/wheels.yml"
    assert "workflow_call" in read(ROOT / ".github" / "workflows" / "wheels.yml")["on"]
    assert "secrets." not in path.read_text(encoding="utf-8")
