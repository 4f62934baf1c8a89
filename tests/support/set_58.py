"""Sets 58 of universal files in text, for tests of their readers."""

import numpy as np


def set58(
    kind: int,
    values: np.ndarray,
    unit: str,
    *,
    name: str = "Head",
    step: float = 5.0,
    over: int = 18,
    under: str = "NONE",
) -> str:
    """Return a set 58 of real or complex values at even steps, written anew."""
    is_complex = np.iscomplexobj(values)
    numbers = np.column_stack((values.real, values.imag)).ravel() if is_complex else values
    rows = [numbers[k : k + 6] for k in range(0, numbers.size, 6)]
    return "\n".join(
        [
            "    -1",
            "    58",
            f"{name:<80}",
            *[f"{'NONE':<80}"] * 4,
            f"{kind:5d}{0:10d}{0:5d}{0:10d} {name:<10}{3:10d}{3:4d} {'NONE':<10}{0:10d}{0:4d}",
            f"{5 if is_complex else 2:10d}{values.size:10d}{1:10d}{0:13.5E}{step:13.5E}{0:13.5E}",
            f"{over:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {'Hz' if over == 18 else 's':<20}",
            f"{12:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {unit:<20}",
            *(f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {label:<20}" for label in (under, "NONE")),
            *("".join(f"{number:13.5E}" for number in row) for row in rows),
            "    -1\n",
        ]
    )
