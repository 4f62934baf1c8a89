"""Maps against exact solutions: lines of the verification table."""

from collections.abc import Callable, Iterator

import pytest
from support import study_lines
from support.impact_lines import Line


@pytest.mark.parametrize(
    "lines",
    [
        pytest.param(
            f, id=f.__name__, marks=pytest.mark.slow if f in (study_lines.limits, study_lines.responses) else ()
        )
        for f in study_lines.ALL
    ],
)
def test_map_finds_the_exact_value(lines: Callable[[], Iterator[Line]]) -> None:
    """Thresholds, amplitudes, limits, multipliers and best designs are within their tolerances."""
    failed = [f"{line.case}: {line.ours!r}, exact {line.exact!r}" for line in lines() if not line.within_tolerance]
    assert not failed, "\n".join(failed)
