"""Contact models of the paper, the second in two interpretations, with their colours in figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rattlebox import Tsuji
from rattlebox.plots import SERIES_COLOURS, SERIES_STYLES

from .reference import CONSTANT, PLASTIC, PLASTIC_RIGID

CONSTANT_E, STEEL, RIGID = "constant restitution", "elasto-plastic, steel wall", "elasto-plastic, rigid wall"

MODELS: Mapping[str, Tsuji] = {CONSTANT_E: CONSTANT, STEEL: PLASTIC, RIGID: PLASTIC_RIGID}
"""Contact law by the name of the model."""

COLOURS: Mapping[str, str] = dict(zip(MODELS, SERIES_COLOURS, strict=False))
STYLES: Mapping[str, Any] = dict(zip(MODELS, SERIES_STYLES, strict=False))


def by_model(texts: Mapping[str, str]) -> str:
    """Return a text with the results of each model.

    Parameters
    ----------
    texts
        Result by model, such as "5 %".
    """
    return (
        f"{texts[CONSTANT_E]} with constant restitution; with the elasto-plastic model {texts[STEEL]} (steel wall) or "
        f"{texts[RIGID]} (rigid wall)"
    )


def described(dims: Any, values: Any, units: str, long_name: str) -> tuple[Any, ...]:
    """Return a variable of a dataset with its unit and meaning.

    Parameters
    ----------
    dims
        Name or names of the dimensions; () for a single number.
    values
        Values of the variable.
    units, long_name
        Attributes of the variable.
    """
    return dims, np.asarray(values), {"units": units, "long_name": long_name}
