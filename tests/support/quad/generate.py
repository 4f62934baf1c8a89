"""Draw random runs, compute them in 113-bit arithmetic, and store them: python -m tests.support.quad.generate."""

from __future__ import annotations

import argparse
import collections
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from .closed_forms import CLOSED_FORMS
from .draw import FAMILIES, STOPS, draw, left_out, parameters, scales
from .runs import Answer, Run, answers, compile_program, digest, question
from .store import CLOSED, DATA, STOPS_DATA, Stored, read, rounded, write

CHECKED = 20
"""One in so many runs has differences with a second step, too, and is computed again with half of the step in time."""
FINER = ("30", "-32")
"""Options of the program for half of the step in time, since 2^-30 = 1e-9: a tolerance of 1e-32 in place of 1e-23."""


def one(
    program: Path, seed: int, number: int, families: Sequence[str] = FAMILIES
) -> tuple[Run, list[str], Answer, collections.Counter[str]]:
    """Return the first run of a number that no rule leaves out, and how many were left out by reason."""
    family = families[number % len(families)]
    reasons: collections.Counter[str] = collections.Counter()
    for trial in range(300):
        rng = np.random.default_rng([seed, number, trial])
        run = draw(rng, family)
        paths = parameters(rng, run)
        # The motion alone first: most runs that are left out show it there.
        (alone,) = answers(program, [question(run, None)])
        reason = alone if isinstance(alone, str) else left_out(run, alone, paths)
        if not reason and not isinstance(alone, str):
            run |= {"end": alone.end, "family": family}
            (answer,) = answers(program, [question(run, paths, number % CHECKED == 0)])
            reason = answer if isinstance(answer, str) else left_out(run, answer, paths)
            if not reason and not isinstance(answer, str):
                return run, paths, answer, reasons
        reasons[reason] += 1
    raise RuntimeError(f"no run of {family}: {dict(reasons)}")


def errors(program: Path, run: Run, paths: list[str], answer: Answer) -> tuple[float, float, float]:
    """Return errors of a checked run, as parts of the largest terms.

    They are the differences of the derivatives by two steps, and of state and derivatives with half of the step in time.
    """
    rows, columns = scales(run, answer.touches, paths)
    terms = np.abs(answer.derivatives * columns / rows[:, None]).max(axis=0)
    terms = np.maximum(terms, 1e-3)

    def part(other: np.ndarray) -> float:
        return float((np.abs((answer.derivatives - other) * columns / rows[:, None]) / terms).max())

    (finer,) = answers(program, [question(run, paths)], FINER)
    assert not isinstance(finer, str)
    return part(answer.second), float(np.abs((finer.state - answer.state) / rows).max()), part(finer.derivatives)


def about(seed: int, left: collections.Counter[str], worst: np.ndarray) -> dict[str, Any]:
    """Return what the file states about itself."""
    return {
        "seed": seed,
        "program": digest(),
        "left_out": dict(sorted(left.items())),
        "errors": worst.tolist(),
    }


def write_closed_forms(program: Path) -> None:
    """Write what the program answers to the runs with closed forms, for machines that cannot compile it."""
    rows = []
    for form in CLOSED_FORMS.values():
        (answer,) = answers(program, [question(form.run, form.paths)])
        assert not isinstance(answer, str), answer
        rows.append(Stored(form.run, form.paths, answer.state, answer.derivatives, answer.touches))
    write(CLOSED, {"program": digest()}, rows)


def merge(parts: list[Path], output: Path) -> dict[str, Any]:
    """Write one file with the runs of several parts, and return what it states about itself."""
    runs, left, worst, seeds = [], collections.Counter[str](), np.zeros(3), set[int]()
    for part in parts:
        stated, several = read(part)
        runs += several
        left.update(stated["left_out"])
        worst = np.maximum(worst, stated["errors"])
        seeds.add(stated["seed"])
    (seed,) = seeds
    for number, each in enumerate(runs):
        each.run["number"] = number
    stated = about(seed, left, worst)
    write(output, stated, runs)
    return stated


def restate(program: Path, path: Path) -> None:
    """State the present program in a file, if it answers one stored run in 20 to the last bit as the former one did."""
    stated, runs = read(path)
    for each in runs[::CHECKED]:
        (answer,) = answers(program, [question(each.run, each.paths)])
        assert not isinstance(answer, str), (each.run["number"], answer)
        assert np.array_equal(answer.state, each.state), each.run["number"]
        assert np.array_equal(rounded(answer.derivatives.copy()), each.derivatives), each.run["number"]
    write(path, stated | {"program": digest()}, runs)


def main() -> None:
    """Generate the file, or a part of it, and print what was left out and how exact the runs are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="number of the first run")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--stops", action="store_true", help="runs with stops")
    parser.add_argument("--output", type=Path, help="default: runs.npz, or stops.npz")
    parser.add_argument(
        "--restate",
        action="store_true",
        help="compute one run in 20 again, and only state the program if all are the same",
    )
    parser.add_argument(
        "--merge", type=Path, nargs="+", metavar="PART", help="parts to write as one file, in their order"
    )
    options = parser.parse_args()
    families, output = (STOPS, STOPS_DATA) if options.stops else (FAMILIES, DATA)
    output = options.output or output
    if options.merge:
        print(merge(options.merge, output))
        return
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "motion"
        if not compile_program(options.compiler, program):
            sys.exit(f"{options.compiler} cannot compile 113-bit arithmetic; try --compiler=g++ with libquadmath")
        write_closed_forms(program)
        if options.restate:
            restate(program, output)
            return
        began = time.time()
        runs, left, worst = [], collections.Counter[str](), np.zeros(3)
        numbers = range(options.first, options.first + options.count)
        with ThreadPoolExecutor(options.jobs) as pool:
            for number, (run, paths, answer, reasons) in zip(
                numbers, pool.map(lambda number: one(program, options.seed, number, families), numbers), strict=True
            ):
                run["number"] = number
                runs.append(Stored(run, paths, answer.state, answer.derivatives, answer.touches))
                left += reasons
                if number % CHECKED == 0:
                    worst = np.maximum(worst, errors(program, run, paths, answer))
                    print(f"{number} {time.time() - began:.0f} s, errors {worst}", file=sys.stderr, flush=True)
    stated = about(options.seed, left, worst)
    write(output, stated, runs)
    print(stated)


if __name__ == "__main__":
    main()
