"""`rattlebox plot`: a figure of a study on disk."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from rattlebox.model.errors import CaseError
from rattlebox.plots.maps import plot_map
from rattlebox.plots.style import WIDTHS
from rattlebox.studies.store import open_study

FORMATS = (".png", ".svg", ".pdf")


def plot_study(study: Path, out: Path, *, kind: str | None, of: str | None, at: Sequence[str], size: str) -> None:
    """Draw a study and write the figure.

    Parameters
    ----------
    study
        Folder of the study.
    out
        File to write, as PNG, SVG or PDF.
    kind, of, size
        As for `rattlebox.plot_map`.
    at
        Texts "axis=value".

    Raises
    ------
    CaseError
        When an argument does not fit, or there is no such study.
    """
    if out.suffix not in FORMATS:
        raise CaseError(
            f"-o {out}: the ending must be one of {', '.join(FORMATS)}\n  try: -o {out.stem or 'study'}.png"
        )
    if size not in WIDTHS:
        raise CaseError(f"--size {size}: there is no such size\n  try: {', '.join(WIDTHS)}")
    if not out.parent.is_dir():
        raise CaseError(f"-o {out}: there is no folder {out.parent}")
    options: dict[str, Any] = {"kind": kind, "size": size}
    plot_map(open_study(study), of, at=_values(at), **options).savefig(out)
    Console(highlight=False).print(f"written: {out}", soft_wrap=True)


def _values(at: Sequence[str]) -> dict[str, str]:
    values = {}
    for text in at:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise CaseError(f'--at "{text}": an axis and a value are needed\n  try: --at "load.amplitude=5 kN"')
        values[name.strip()] = value.strip()
    return values
