"""Ready maps against exact solutions: the lines of the verification table."""

from collections.abc import Callable, Iterator

import pytest

from . import maps
from .measures import Line


@pytest.mark.parametrize("lines", maps.ALL, ids=lambda f: f.__name__)
def test_map_finds_the_exact_value(lines: Callable[[], Iterator[Line]]) -> None:
    """Thresholds, amplitudes, limits, multipliers and best designs are found within what the method allows."""
    failed = [f"{line.case}: {line.ours!r}, exact {line.exact!r}" for line in lines() if not line.held]
    assert not failed, "\n".join(failed)
