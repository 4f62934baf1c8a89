"""Write a report to a file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rattlebox._util.atomic_io import atomic_write, check_suffix, require_folder
from rattlebox._util.exceptions import DataError
from rattlebox._util.own_files import claim, seal

if TYPE_CHECKING:
    from rattlebox.model.case import Case

    from .page import Section

_SUFFIXES = (".html", ".htm")


def write_report(
    result: object,
    path: str | os.PathLike[str],
    *,
    title: str | None = None,
    question: str | None = None,
    case: Case | None = None,
) -> Path:
    """Write a report about a result: one HTML page, without other files, that prints on A4.

    The page has the question and its answer with 95 % intervals, a drawing of the case to scale, a table of the inputs with
    units, the figures, all warnings, the limits of the method, and what is needed to compute the result again.

    Parameters
    ----------
    result
        A run, the result of `rb.compare`, the dataset of a study (`rb.sweep`, `rb.frequency_response`, `rb.loss_map`,
        `rb.damping_curve`, `rb.design`, ..., or `rb.open_study`, also of an unfinished study), a branch of periodic motions,
        or a mapping of several of them by name. Runs in a mapping, and damping curves in a mapping, are compared with
        each other.
    path
        File to write, .html. An earlier report is replaced; any other file, and a report that was edited, is not.
    title
        Title of the page; default the name of the case, or the kind of the result.
    question
        Question that the result answers, in place of the one that follows from its kind.
    case
        Case of a dataset that does not hold it, such as a loss map from another file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CaseError
        If there is no report about the result.
    DataError
        If the file exists and is not a report of Rattlebox or has changed since, or cannot be written.
    ResourceError
        If no space is left on the disk.

    Examples
    --------
    >>> import rattlebox as rb
    >>> run = rb.simulate(rb.reference_case(duration=0.1))
    >>> path = rb.write_report(run, "report.html")  # doctest: +SKIP
    """
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        check_suffix(path, ".html")
        raise DataError(f"{path}: a report is an HTML file", str(path.with_suffix(".html")))
    require_folder(path)
    with claim([path]):
        # Drawing and rendering take longer than the checks above.
        from .page import render, sections_of

        sections = list(sections_of(_compared(result), case, question))
        content = render(sections, title or _title(result, sections)).encode()
        with atomic_write(path, "make room and write the report again") as name:
            name.write_bytes(seal(content, path.suffix.lower()))
    return path


def _compared(result: object) -> Any:
    """Return a mapping of runs as their comparison, and other results unchanged."""
    from rattlebox.results.run import Run
    from rattlebox.results.summary import Comparison

    if isinstance(result, Mapping) and result and all(isinstance(each, Run) for each in result.values()):
        return Comparison({str(name): run for name, run in result.items()})
    return result


def _title(result: object, sections: list[Section]) -> str:
    name = ""
    source = getattr(result, "source", None)
    if source is not None and not isinstance(source, str):
        name = source.name
    elif len(sections) == 1 and hasattr(result, "case_toml"):
        import tomllib

        name = str(tomllib.loads(result.case_toml).get("name", ""))
    return name or (sections[0].kind if len(sections) == 1 else "Report")
