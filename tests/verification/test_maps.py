"""Maps against exact solutions: lines of the verification table."""

from collections.abc import Callable, Iterator

import pytest
from support import known_maps
from support.known_impacts import Comparison


@pytest.mark.parametrize(
    "lines",
    [
        pytest.param(f, id=f.__name__, marks=pytest.mark.slow if f in (known_maps.limits, known_maps.responses) else ())
        for f in known_maps.ALL
    ],
)
def test_map_finds_the_exact_value(lines: Callable[[], Iterator[Comparison]]) -> None:
    """Thresholds, amplitudes, limits, multipliers and best designs are within their tolerances."""
    failed = [f"{line.case}: {line.ours!r}, exact {line.exact!r}" for line in lines() if not line.within_tolerance]
    assert not failed, "\n".join(failed)
