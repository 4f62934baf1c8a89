"""Comparison of several cases in one table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rattlebox.engines.simulate import simulate_many
from rattlebox.model.case import Case
from rattlebox.model.errors import Hint
from rattlebox.results.run import Run
from rattlebox.results.summary import Comparison

if TYPE_CHECKING:
    from typing import Any


def compare(
    cases: Mapping[str, Case | Run],
    *,
    threads: int | None = None,
    progress: bool | Callable[[int, int], object] = True,
) -> Comparison:
    """Simulate several cases and compare their results in one table.

    Parameters
    ----------
    cases
        Cases, or runs of them, by the name of their column, such as "bare", "tuned mass" and "particles". The first one is
        the reference.
    threads
        Number of threads; default all cores.
    progress
        See `rb.simulate_many`.

    Returns
    -------
    Comparison
        Table with `values` in SI units, including the reduction of peak and RMS values against the first case, and with
        `runs`, which `rb.plot_comparison` draws.

    Raises
    ------
    CaseError
        If `cases` is not a mapping of names to cases and runs, or is empty.

    Examples
    --------
    >>> import rattlebox as rb
    >>> structure = rb.SDOF(mass="20 kg", stiffness="80 kN/m", damping_ratio=0.01)
    >>> common = {"structure": structure, "load": rb.HalfSine(amplitude="5 kN", duration="1 ms"), "duration": "3 s"}
    >>> result = rb.compare(
    ...     {
    ...         "bare": rb.Case(**common),
    ...         "tuned mass": rb.Case(**common, tuned_mass=rb.TunedMass.den_hartog(structure, mass="1 kg")),
    ...     }
    ... )
    >>> result.values["tuned mass"]["rms_reduction[mass]"] > 0.5
    True
    """
    if not isinstance(cases, Mapping) or not cases:
        raise Hint("cases is not a mapping of names to cases, or is empty", 'compare({"bare": case, "damped": other})')
    for name, each in cases.items():
        if not isinstance(each, (Case, Run)):
            raise Hint(f"{name!r} is {each!r:.60}, but a Case or a Run is needed", "rb.Case(...)")
    new = [each for each in cases.values() if isinstance(each, Case)]
    simulated = iter(simulate_many(new, threads=threads, progress=progress))
    runs: dict[str, Any] = {
        str(name): next(simulated) if isinstance(each, Case) else each for name, each in cases.items()
    }
    return Comparison(runs)
