"""Kernels are compiled where there is neither card nor driver."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rattlebox.engines import gpu
from rattlebox.model.errors import CaseError

KERNEL = """
#include <algorithm>
#include <vector>

#include "base/quadrature.hpp"
#include "base/rows.hpp"

using namespace rattlebox;

extern "C" __global__ void prepare() { new (&room<GaussRule>) GaussRule; }

extern "C" __global__ void work(const real* in, Row* out, int n) {
    alignas(64) char mine[MEMORY];
    gpu::Arena arena;
    arena.near = {mine, mine, mine + MEMORY};
    gpu::use(arena);
    std::vector<real> sorted;
    for (int i = 0; i < n; ++i) sorted.push_back(in[i]);
    out[threadIdx.x] = row(*std::upper_bound(sorted.begin(), sorted.end(), 0.5), total(lanes(in)),
                           integrate(1.0, [](real x) { return square(x); }), std::sin(in[0]));
}
"""


@pytest.fixture
def kernel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A source file, and a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "work.cpp"
    file.write_text(KERNEL)
    return file


def test_kernels_are_compiled_once(kernel: Path, tmp_path: Path) -> None:
    """The second time the code comes from the cache; with other macros, or when the file is damaged, it does not."""

    def compiled(memory: int = 4096) -> gpu.Compiled:
        return gpu.compile_kernels(str(kernel), "sm_90", RATTLEBOX_THREADS=64, MEMORY=memory)

    first, again = compiled(), compiled()
    assert first.code == again.code and first.code[:4] == b"\x7fELF"
    assert first.seconds > 0 and again.seconds == 0
    assert set(first.resources) == {"prepare", "work"}
    assert first.resources["work"].stack > 4096 and first.resources["work"].shared == 64 * 8
    assert 16 < first.resources["work"].registers < 256
    assert compiled(8192).resources["work"].stack > 8192
    for file in [file for file in (tmp_path / "cache").rglob("*") if file.is_file()]:
        file.write_bytes(file.read_bytes()[:-100])
    mended = compiled()
    assert mended.code == first.code and mended.seconds > 0
    assert compiled().seconds == 0


def test_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the extra, the error names the package and the command."""
    real_import = gpu.import_module

    def refused(name: str, *rest: Any) -> Any:
        if name.startswith("cuda"):
            raise ModuleNotFoundError("No module named 'cuda'", name="cuda")
        return real_import(name, *rest)

    monkeypatch.setattr(gpu, "import_module", refused)
    with pytest.raises(CaseError, match=r"cuda-core[\s\S]*pip install 'rattlebox\[gpu\]'"):
        gpu.nvrtc()
