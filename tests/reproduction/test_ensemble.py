"""Ensembles of start positions and their bands."""

import numpy as np
import pytest

from reproduction.system import GAP, START, band, ensemble, near, paper_case


@pytest.mark.parametrize("start", START.values())
def test_members_start_apart_and_within_reach(start):
    """Members have different starts within the reach, also where the wall leaves them one side only."""
    runs = ensemble(lambda offset: paper_case(start=near(start, offset), duration=1e-3), members=9, reach=2e-6)
    places = np.array([run.arrays.relative_position[0, 0] for run in runs])
    offsets = np.abs(places - start * GAP)
    assert np.unique(places).size == 9
    assert offsets.max() <= 2e-6 * (1 + 1e-9)
    assert offsets.max() > 1.5e-6
    assert np.abs(places).max() <= GAP


def test_ensemble_is_the_same_in_every_call():
    """Two calls give the same bits."""
    first, second = (
        ensemble(lambda offset: paper_case(start=near(0.0, offset), duration=3.0), members=3) for _ in range(2)
    )
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a.ledger.channels["normal"], b.ledger.channels["normal"])


def test_band_holds_four_fifths():
    """The band of equally spaced values lies at a tenth, a half and nine tenths of their range."""
    values = np.linspace(0.0, 10.0, 11)[:, None] * np.array([1.0, -1.0])
    low, median, high = band(values)
    np.testing.assert_allclose(low, [1.0, -9.0], atol=1e-14)
    np.testing.assert_allclose(median, [5.0, -5.0], atol=1e-14)
    np.testing.assert_allclose(high, [9.0, -1.0], atol=1e-14)
    np.testing.assert_allclose(band(values.T, axis=1)[2], high)


def test_no_member_is_refused():
    """An ensemble without members is refused with the number that was given."""
    with pytest.raises(ValueError, match="members is 0"):
        ensemble(lambda offset: paper_case(), members=0)
