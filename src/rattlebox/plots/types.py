"""Types that all figures share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rattlebox.results.figures import Size as Size

Style = dict[str, Any]
"""Options of artists of Matplotlib by name."""
Vector = NDArray[np.float64]
