"""Modes in text results of Nastran and CalculiX."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

OMEGA2 = [3.1e-7, 8.4e5, 2.25e6]
SHAPES = np.array(
    [[[0.21, 0.0, -1.5], [0.0, 0.4, 0.75]], [[1e-3, 0.0, 2.5], [-0.31, 0.0, 1.0]], [[0.0, 0.0, -0.5], [0.0, 0.6, -7.5]]]
)
VECTOR = "R E A L   E I G E N V E C T O R   N O ."
NODES = [12, 3045]
MASSES = [1.0, 2.5, 0.4]


def f06() -> str:
    """Return the tables of a .f06 file, with a page break within an eigenvector."""
    head = "1    BEAM                                        MARCH  3, 2024  SIMCENTER NASTRAN   PAGE     3\n"
    text = (
        head + " " * 47 + "R E A L   E I G E N V A L U E S\n   MODE    EXTRACTION      EIGENVALUE            RADIANS\n"
    )
    for k, (square, mass) in enumerate(zip(OMEGA2, MASSES, strict=True), start=1):
        values = (square, square**0.5, square**0.5 / 6.283185307, mass, mass * square)
        text += f"{k:9d}{k:10d}" + "".join(f"{x:20.6E}" for x in values) + "\n"
    for k, shape in enumerate(SHAPES, start=1):
        title = f"      EIGENVALUE = {OMEGA2[k - 1]:13.6E}\n          CYCLES =  1.0E+01     {VECTOR}{k:11d}\n \n"
        title += "      POINT ID.   TYPE          T1             T2             T3             R1\n"
        text += head + title
        for node, row in zip(NODES, shape, strict=True):
            text += f"{node:14d}      G   " + "".join(f"{x:15.6E}" for x in (*row, 0.0, 0.1, 0.0)) + "\n"
            text += head + title if k == 2 else ""
        text += f"{9001:14d}      S   {0.3:15.6E}\n"
    return text


def punch() -> str:
    """Return a punch file with eigenvectors."""
    lines = ["$TITLE   = BEAM", "$EIGENVECTOR", "$REAL OUTPUT", "$SUBCASE ID =           1"]
    for k, shape in enumerate(SHAPES, start=1):
        lines.append(f"$EIGENVALUE ={OMEGA2[k - 1]:15.7E}  MODE ={k:6d}")
        for node, row in zip(NODES, shape, strict=True):
            lines.append(f"{node:10d}       G" + "".join(f"{x:18.6E}" for x in row))
            lines.append(f"{'-CONT-':18s}" + f"{0.0:18.6E}" * 3)
    return "".join(f"{line:72s}{number:8d}\n" for number, line in enumerate(lines, start=1))


def frd() -> str:
    """Return a .frd file with modes and stresses, whose numbers fill their columns."""
    text = (
        "    1C\n    2C"
        + " " * 18
        + f"{2:12d}"
        + " " * 37
        + "1\n -1        12 0.00000E+00 0.00000E+00 0.00000E+00\n -3\n"
    )
    for k, shape in enumerate(SHAPES, start=1):
        mass, square = MASSES[k - 1], OMEGA2[k - 1]
        text += (
            f"    1PSTEP{k:26d}{1:12d}{1:12d}\n    1PGM{mass:28.6E}\n    1PGK{mass * square:28.6E}\n    1PMODE{k:26d}\n"
        )
        for name in ("DISP", "STRESS"):
            text += f"  100CL  10{k} 1.00000E+01           2             2    1MODAL      1\n -4  {name:8s}    4    1\n"
            for node, row in zip(NODES, shape, strict=True):
                text += f" -1{node:10d}" + "".join(f"{x:12.5E}" for x in row) + "\n"
            text += " -3\n"
    return text + " 9999\n"


FILES = {"a.f06": (f06(), True), "a.pch": (punch(), False), "a.frd": (frd(), True)}
OPTIONS: dict[str, Any] = {"points": {"a": 12, "b": 3045}, "damping_ratio": 0.01}


@pytest.mark.parametrize("name", FILES)
def test_planted_modes(tmp_path: Path, name: str) -> None:
    """Planted frequencies, shapes and modal masses are read; the eigenvalue of a rigid-body mode becomes zero.

    Modes of Nastran and CalculiX could not be read at all.
    """
    text, has_masses = FILES[name]
    (tmp_path / name).write_text(text)
    modal = rb.Modal.from_file(tmp_path / name, **OPTIONS)
    np.testing.assert_allclose(modal.frequencies, [0.0, *(np.sqrt(OMEGA2[1:]) / (2 * np.pi))], rtol=1e-5)
    root = np.sqrt(MASSES if has_masses else np.ones(3))[:, None]
    for k, point in enumerate(("a", "b")):
        np.testing.assert_allclose(modal.modes().shapes[point], SHAPES[:, k] / root, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("a.f06", "R E A L   E I G E N V E C", "C O M P L E X   E I G E N V E C", r"line \d+: complex modes"),
        ("a.f06", "R E A L   E I G E N V A L U E S", "", "no eigenvalue of mode 1"),
        ("a.f06", "R E A L   E I G E N V E C", "", "no mode shape"),
        ("a.pch", "       G", "       Q", r"line \d+: .* no point"),
        ("a.pch", "$EIGENVALUE", "$VALUE", "no mode shape"),
        ("a.pch", "-1.500000E+00", "-1.5x0000E+00", r"line \d+: .* not numbers"),
        ("a.frd", "1PGM", "1PXX", "no generalized mass"),
        ("a.frd", "    1C", "hello", "line 1: .* no start"),
        ("a.frd", "-1.50000E+00", "-1.5x000E+00", r"line \d+: .* not numbers"),
    ],
)
def test_damaged_results(tmp_path: Path, name: str, old: str, new: str, message: str) -> None:
    """Complex, incomplete and damaged results are refused with the file, and the line where there is one."""
    text = FILES[name][0]
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new))
    with pytest.raises(rb.DataError, match=message):
        rb.Modal.from_file(tmp_path / name, **OPTIONS)


def test_a_mode_that_is_cut_short(tmp_path: Path) -> None:
    """A .frd file that ends within the displacements of a mode is refused."""
    text = FILES["a.frd"][0]
    (tmp_path / "a.frd").write_text(text[: text.index(" -3\n", text.index("DISP"))])
    with pytest.raises(rb.DataError, match="ends within the displacements"):
        rb.Modal.from_file(tmp_path / "a.frd", **OPTIONS)


@pytest.mark.parametrize("name", FILES)
def test_mutants(tmp_path: Path, name: str) -> None:
    """Files with random damage are read or refused within two seconds, without any other error."""
    content, path = FILES[name][0].encode(), tmp_path / name
    random = np.random.default_rng(7)
    for _ in range(300):
        mutant = bytearray(content)
        for _ in range(random.integers(1, 8)):
            where = int(random.integers(len(mutant)))
            mutant[where : where + int(random.integers(0, 4))] = random.integers(
                32, 127, random.integers(0, 4), dtype=np.uint8
            ).tobytes()
        path.write_bytes(bytes(mutant[: int(random.integers(1, len(mutant) + 1))] if random.random() < 0.2 else mutant))
        begin = time.process_time()
        with contextlib.suppress(rb.RattleboxError):
            rb.Modal.from_file(path, **OPTIONS)
        assert time.process_time() - begin < 2.0
