"""Types that all figures share."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Size = Literal["column", "page", "slide"]
Style = dict[str, Any]
"""Options of artists of Matplotlib by name."""
Vector = NDArray[np.float64]
