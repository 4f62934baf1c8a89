"""Studies on a graphics card: what runs there, and what is told where there is none."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.cli.main import main
from rattlebox.engines import gpu_impact
from rattlebox.engines.core import core
from rattlebox.engines.gpu_impact import THREADS, Need
from rattlebox.model.errors import CaseError
from rattlebox.paper.seed import seed_case
from rattlebox.results import Run
from rattlebox.studies import follow, lyapunov, task

CASE = seed_case(duration=0.3)
SHAKEN = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="4 kN/m", damping_ratio=0.01),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    load=rb.Harmonic(amplitude="5 N", frequency="10 Hz"),
    duration="1 s",
)
AXES = {"damper.gap": rb.linspace("0.2 mm", "1 mm", 40)}
LINEAR = rb.Linear(stiffness=500.0, restitution=0.6)


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """A card that computes on the processor; ranges of variants that were asked of it."""
    asked: list[tuple[int, int]] = []

    def run(packed: Any, shape: Any, start: int, stop: int, progress: Any, **kept: Any) -> Any:
        asked.append((start, stop))
        return core().sweep(packed, list(shape), start, stop, **kept, progress=progress)

    monkeypatch.setattr(gpu_impact, "ready", lambda: ("sm_90", "a card of that kind"))
    monkeypatch.setattr(gpu_impact, "run_members", run)
    return asked


def test_sweeps_run_on_a_card_block_by_block(fake: list[tuple[int, int]], monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks go to the card one by one, with progress; the result is that of the processor."""
    monkeypatch.setattr(task, "_CARD_BLOCK", 16)
    told: list[tuple[int, int]] = []
    found = rb.sweep(CASE, AXES, ["impacts", "peak"], on="gpu", progress=lambda *done: told.append(done))
    assert [stop - start for start, stop in fake] == [14, 14, 12]
    assert told[-1] == (40, 40) and found.gpu == "a card of that kind"
    wanted = rb.sweep(CASE, AXES, ["impacts", "peak"])
    for name in wanted.data_vars:
        np.testing.assert_array_equal(found[name], wanted[name])


def test_pairs_are_parted_on_a_card(fake: list[tuple[int, int]], monkeypatch: pytest.MonkeyPatch) -> None:
    """Motions and neighbours of as many variants as keep a card busy run at once, to the processor's exponents."""
    monkeypatch.setattr(lyapunov, "_MOTIONS", 8)
    gaps = {"damper.gap": rb.linspace("0.5 mm", "1.5 mm", 4)}
    told: list[int] = []
    options: dict[str, Any] = {"cycles": (4, 3), "pairs": 2, "progress": lambda done, _: told.append(done)}
    there, here = (rb.lyapunov(SHAKEN, gaps, on=on, **options) for on in ("gpu", None))
    assert {stop for _, stop in fake} == {2 * 2, 2 * 2 * 2} and told[-1] == 4
    assert np.isfinite(here.exponent).all()
    for name in here.data_vars:
        np.testing.assert_array_equal(there[name], here[name])


def test_walks_are_taken_side_by_side(fake: list[tuple[int, int]], monkeypatch: pytest.MonkeyPatch) -> None:
    """Levels and directions of a frequency response go on together, value by value, each as on the processor."""
    soft = rb.ImpactDamper(ball=rb.Sphere(radius="10 mm", material="steel"), gap="1 mm", contact=LINEAR)
    case = SHAKEN.model_copy(update={"dampers": (soft,)})
    told: list[int] = []
    options: dict[str, Any] = {"levels": ["4 N", "5 N", "8 N"], "cycles": (4, 2), "samples": 8}
    options["progress"] = lambda done, _: told.append(done)
    there, here = (rb.frequency_response(case, [9.0, 9.5, 10.0], on=on, **options) for on in ("gpu", None))
    assert {stop for _, stop in fake} == {6, 5, 3} and told[-1] == 18  # some contacts are closed at the end of a cycle
    assert (here.status == 0).all()
    for name in here.data_vars:
        np.testing.assert_array_equal(there[name], here[name])
    monkeypatch.setattr(follow, "_WALKS", 2)
    fake.clear()
    again = rb.frequency_response(case, [9.0, 9.5, 10.0], on="gpu", **options)
    assert max(stop for _, stop in fake) == 2 and again.equals(there)


def test_a_study_goes_on_where_it_began(fake: list[tuple[int, int]], tmp_path: Path) -> None:
    """A store that was begun on a card is not gone on with on the processor, whose bits differ."""
    rb.sweep(CASE, AXES, on="gpu", store=tmp_path / "study")
    fake.clear()
    rb.sweep(CASE, AXES, on="gpu", store=tmp_path / "study")
    assert fake == []
    with pytest.raises(CaseError, match="sm_90"):
        rb.sweep(CASE, AXES, store=tmp_path / "study")


def own(run: Run) -> float:
    """A measure of a user."""
    return float(run.time[-1])


@pytest.mark.parametrize(
    ("study", "told"),
    [
        (lambda: rb.sweep(CASE, AXES, [own], on="gpu"), "own is a function of a Run"),
        (lambda: rb.sweep(CASE, AXES, on="tpu"), "on = 'tpu'"),
        (
            lambda: rb.bifurcation(SHAKEN, "load.amplitude", [4.0, 5.0], direction="up", on="gpu"),
            "each value goes on from the one before, so there is nothing to run side by side",
        ),
    ],
)
def test_what_a_card_cannot_do_is_told(fake: list[tuple[int, int]], study: Callable[[], object], told: str) -> None:
    """The error names what it is and what to do instead."""
    with pytest.raises(CaseError, match=rf"{told}[\s\S]*try: "):
        study()


def test_a_card_that_is_not_there_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without driver or card, the error says so and how to get it; the command ends with exit code 2."""
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "")
    with pytest.raises(CaseError, match=r"driver[\s\S]*try: "):
        rb.sweep(CASE, AXES, on="gpu")
    study = tmp_path / "study.toml"
    (tmp_path / "case.toml").write_text(CASE.to_toml())
    study.write_text('[case]\nfile = "case.toml"\n[axes]\n"damper.gap" = ["0.2 mm", "0.4 mm"]\n')
    for more in ([], ["--workers", "2"]):
        monkeypatch.setattr(sys, "argv", ["rattlebox", "sweep", str(study), "--gpu", *more])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 2
        assert ("--workers" if more else "driver") in capsys.readouterr().err


def test_the_memory_of_a_card_is_reckoned() -> None:
    """As many threads work as fit; where none does, the error has the number."""
    need = Need(thread=2**20, member=2**10, local=2**30)
    assert need.threads(free=2**36, members=10**6, most=33792) == 33792
    assert need.threads(free=2**36, members=1000, most=33792) == 1024
    few = need.threads(free=2**33, members=10**5, most=33792)
    assert few % THREADS == 0 and few * 2**20 + 10**5 * 2**10 + 2**30 <= 0.9 * 2**33 < (few + THREADS) * 2**20 + 2**31
    with pytest.raises(CaseError, match=r"1,000,000 variants need 2\.08 GiB on the card, 1 GiB are free"):
        need.threads(free=2**30, members=10**6, most=33792)
