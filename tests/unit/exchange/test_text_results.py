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


PARTICIPATION = [[0.5, -0.2, 0.0], [0.25, 0.125, -0.0625], [1e-9, 0.5, 2.0]]
TOTAL = [0.4, 0.5, 4.5]


def dat() -> str:
    """Return a .dat file: a static step, eigenvalues, participation, effective masses, and displacements of two sets."""

    def table(title: str, heads: str, rows: dict[str, Any]) -> str:
        lines = "".join(f"{label:>7s}" + "".join(f"{x:16.7E}" for x in row) + "\n" for label, row in rows.items())
        return f"\n     {' '.join(title)}\n\n{heads}\n\n{lines}"

    modes = [str(k) for k in range(1, 4)]
    text = " displacements (vx,vy,vz) for set NALL and time  0.1000000E+01\n\n"
    text += f"{12:10d}" + "".join(f"{x:14.6E}" for x in (9.0, 9.0, 9.0)) + "\n"
    roots = {k: (w, abs(w) ** 0.5, abs(w) ** 0.5 / (2 * np.pi), 0.0) for k, w in zip(modes, OMEGA2, strict=True)}
    text += table("EIGENVALUE OUTPUT", " MODE NO    EIGENVALUE                       FREQUENCY", roots)
    heads = "MODE NO.   X-COMPONENT     Y-COMPONENT     Z-COMPONENT     X-ROTATION      Y-ROTATION      Z-ROTATION"
    factors = np.hstack([PARTICIPATION, np.full((3, 3), 0.01)])
    text += table("PARTICIPATION FACTORS", heads, dict(zip(modes, factors, strict=True)))
    text += table("EFFECTIVE MODAL MASS", heads, dict(zip(modes, factors**2, strict=True)))
    text += "TOTAL  " + "".join(f"{x:16.7E}" for x in (factors**2).sum(axis=0)) + "\n"
    text += table("TOTAL EFFECTIVE MASS", heads, {"": [*TOTAL, 0.1, 0.1, 0.1]})
    for k, shape in enumerate(SHAPES, start=1):
        text += f"\n\n{' ' * 20}E I G E N V A L U E    N U M B E R {k:5d}\n\n"
        for name, rows in (("ENDS", [0, 1]), ("TIP", [1])):
            text += f"\n displacements (vx,vy,vz) for set {name} and time  0.2000000E+01\n\n"
            text += "".join(f"{NODES[n]:10d}" + "".join(f"{x:14.6E}" for x in shape[n]) + "\n" for n in rows)
        text += "\n forces (fx,fy,fz) for set TIP and time  0.2000000E+01\n\n"
        text += f"{12:10d}" + f"{7.0:14.6E}" * 3 + "\n"
    return text


FILES = {"a.f06": (f06(), True), "a.pch": (punch(), False), "a.frd": (frd(), True), "a.dat": (dat(), False)}
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
        ("a.dat", "-1.500000E+00", "-1.5x0000E+00", r"line \d+: .* not numbers"),
        ("a.dat", "-1.500000E+00", "-1.500000E+00 L", r"line \d+: .* local axes .*\n.*GLOBAL=YES"),
        ("a.dat", "E I G E N V A L U E   O", "E I G E N T H I N G   O", "no table of eigenvalues"),
        ("a.dat", "N U M B E R", "N U M B E Q", "no mode shape"),
        ("a.dat", "E F F E C T I V E   M O", "E F F E C T I V E   N O", "no participation or effective mass"),
        ("a.dat", "2.5000000E-01", "2.7000000E-01", "not the squares of the participation"),
        ("a.dat", " MODE NO  ", " MODE NO   NODAL DIAMETER", "cyclic sector"),
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
    """A file that ends before or within the displacements of a mode is refused, or has a note if they may be unwanted."""
    text = FILES["a.frd"][0]
    (tmp_path / "a.frd").write_text(text[: text.index(" -3\n", text.index("DISP"))])
    with pytest.raises(rb.DataError, match="ends within the displacements"):
        rb.Modal.from_file(tmp_path / "a.frd", **OPTIONS)
    text = FILES["a.dat"][0]
    (tmp_path / "a.dat").write_text(text[: text.rindex("E I G E N V A L U E")])
    with pytest.raises(rb.DataError, match="ends before the displacements of mode 3"):
        rb.Modal.from_file(tmp_path / "a.dat", **OPTIONS)
    text = FILES["a.f06"][0]
    (tmp_path / "a.f06").write_text(text[: text.rindex("      EIGENVALUE = ")])
    assert "the shapes of 2 of its 3 modes" in "\n".join(rb.Modal.from_file(tmp_path / "a.f06", **OPTIONS).notes())


def test_residual_vectors_of_nastran(tmp_path: Path) -> None:
    """With residual vectors Nastran prints the eigenvalues twice; those after the augmentation belong to the shapes.

    Such files were refused as results of two analyses: no test had the second table.
    """
    text, title = FILES["a.f06"][0], "R E A L   E I G E N V A L U E S\n"
    first = text[text.index(" " * 47 + title) : text.index("1    BEAM", 10)]
    before = first.replace(title, title + f"{'(BEFORE AUGMENTATION OF RESIDUAL VECTORS)':>82s}\n").replace(
        "2.250000E+06", "2.300000E+06"
    )
    after = first.replace(title, title + f"{'(AFTER AUGMENTATION OF RESIDUAL VECTORS)':>81s}\n")
    head = text[: text.index("\n") + 1]
    (tmp_path / "a.f06").write_text(head + before + head + after + text.replace(first, ""))
    modal = rb.Modal.from_file(tmp_path / "a.f06", **OPTIONS)
    np.testing.assert_allclose(modal.frequencies[1:], np.sqrt(OMEGA2[1:]) / (2 * np.pi), rtol=1e-5)
    (tmp_path / "a.f06").write_text(head + before + text.replace(first, ""))
    with pytest.raises(
        rb.DataError, match=r"mode 3 has the eigenvalue 2.25e\+06 above its shape, but 2.3e\+06 in the table"
    ):
        rb.Modal.from_file(tmp_path / "a.f06", **OPTIONS)


def test_participation_of_calculix(tmp_path: Path) -> None:
    """Participation and total mass are those of the file, for a point in 3-D and for one direction.

    The tables of .dat files could not be read, so that a moving base needed numbers typed by hand.
    """
    (tmp_path / "a.dat").write_text(FILES["a.dat"][0])
    modal = rb.Modal.from_file(tmp_path / "a.dat", **OPTIONS)
    np.testing.assert_allclose(modal.participation, PARTICIPATION, rtol=1e-6)
    np.testing.assert_allclose(modal.total_mass, TOTAL, rtol=1e-6)
    along_z = rb.Modal.from_file(tmp_path / "a.dat", points={"a": "12 z"}, damping_ratio=0.0)
    np.testing.assert_allclose(along_z.participation, np.array(PARTICIPATION)[:, 2], rtol=1e-6, atol=1e-12)
    assert along_z.total_mass == pytest.approx(TOTAL[2])
    (tmp_path / "record.dat").write_text("0 1\n1 2\n2 3\n")
    with pytest.raises(rb.DataError, match=r"modes cannot be read from files with the ending '\.dat'"):
        rb.Modal.from_file(tmp_path / "record.dat", **OPTIONS)


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
