"""Runs a kernel of faults.cpp, `python faults.py NAME`, and prints what it wrote or what the driver says."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from rattlebox.engines.card import Card

THREADS = 64


def main(name: str) -> None:
    """Run it."""
    card, out = Card(), np.zeros(THREADS, np.int32)
    file = Path(__file__).with_name("faults.cpp")
    _, kernel = card.kernels(str(file), RATTLEBOX_THREADS=THREADS)
    work = kernel(name if f"void {name}(" in file.read_text(encoding="utf-8") else "fresh")
    how = {"beyond_shared": {"shared": 64}, "too_many_blocks": {"at_once": True}, "too_much_shared": {"shared": 10**6}}
    blocks, threads = (1000 if name == "too_many_blocks" else 1), (65 if name == "too_many_threads" else THREADS)
    try:
        with card.room(100 if name == "beyond_memory" else out.nbytes) as room:
            if name == "elsewhere":
                card.upload(room, np.array([out.ctypes.data]))
            if name == "not_on_the_card":
                card.launch(work, 1, THREADS, out.ctypes.data)
            else:
                card.launch(work, blocks, threads, room, **how.get(name, {}))
            card.wait()
            if name != "beyond_memory":
                card.download(room, out)
        card.wait()
        if name == "given_back":
            card.download(room, out)
    except Exception as error:
        print(type(error).__name__, error)
    else:
        print(out.tolist())


if __name__ == "__main__":
    main(sys.argv[1])
