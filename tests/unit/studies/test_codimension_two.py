"""Names of the points of a curve of special points at which a second condition is met."""

import numpy as np
import pytest

from rattlebox.studies.orbits.codimension_two import names_along

LINE = np.linspace(-1.0, 1.0, 9) + 0.03
PLACES = np.stack([LINE, 0.5 * LINE], axis=1)


def rows(first, second):
    """Return multipliers along a curve: a critical one, and another one that passes a value at the fifth point."""
    return np.stack([np.full(LINE.size, first), second + 0.2 * LINE, np.full(LINE.size, 0.1)], axis=1).astype(complex)


@pytest.mark.parametrize(
    ("kind", "first", "second", "name"),
    [
        ("fold", 1.0, 1.0, "1:1 resonance"),
        ("fold", 1.0, -1.0, "fold-flip"),
        ("flip", -1.0, -1.0, "1:2 resonance"),
        ("flip", -1.0, 1.0, "fold-flip"),
    ],
)
def test_second_multiplier(kind, first, second, name):
    """A second real multiplier on the unit circle is named at the point nearest to it, and only there."""
    assert names_along(kind, rows(first, second), PLACES) == [name if k == 4 else "" for k in range(LINE.size)]


def test_a_point_exactly_at_the_condition():
    """A second multiplier that is exactly +1 at a point is named there; products of neighbours, which are 0, missed it."""
    second = np.array([0.5, 0.75, 1.0, 1.25, 1.5])
    multipliers = np.stack([np.full(5, -1.0), second, np.full(5, 0.1)], axis=1).astype(complex)
    assert names_along("flip", multipliers, PLACES[:5]) == ["", "", "fold-flip", "", ""]


def test_angles_of_a_torus():
    """Angles of 90 and 120 degrees are named along a Neimark-Sacker curve."""
    angles = np.linspace(1.4, 2.3, 19)
    pair = np.exp(1j * angles)
    names = names_along("torus", np.stack([pair, pair.conj(), 0 * pair + 0.2], axis=1), np.zeros((19, 2)))
    found = {name: angles[k] for k, name in enumerate(names) if name}
    assert found == {
        "1:4 resonance": pytest.approx(np.pi / 2, abs=0.03),
        "1:3 resonance": pytest.approx(2.094, abs=0.03),
    }


def test_cusp():
    """The fold curve of p + q x + x^3 = 0, p = 2 x^3 and q = -3 x^2, has a cusp at zero."""
    x = LINE
    names = names_along("fold", rows(1.0, 0.5), np.stack([2 * x**3, -3 * x**2], axis=1))
    assert [name for name in names if name] == ["cusp"]
    assert abs(x[names.index("cusp")]) < 0.2
