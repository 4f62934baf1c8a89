"""What the kernels take of a card, told by the assembler for three generations of cards."""

from __future__ import annotations

import pytest

from rattlebox.engines.dem_gpu import launch_bounds
from rattlebox.engines.gpu import Resources, compile_kernels
from rattlebox.engines.gpu_impact import THREADS

ARCHITECTURES = ["sm_80", "sm_90", "sm_100"]
BOUNDS = {
    "prepare": Resources(registers=128, stack=9_000, shared=0),
    "impact": Resources(registers=255, stack=40_000, shared=8 * THREADS),
}
SPILLS = 10_000
"""Of the stack of `impact`, 16 KiB are vectors; the rest is the trajectory itself, with its two lone contacts."""


@pytest.mark.parametrize("arch", ARCHITECTURES)
def test_kernels_of_impact_dampers_are_bounded(arch: str) -> None:
    """They compile for each generation, and take no more registers and memory than stated."""
    compiled = compile_kernels("impact.cpp", arch, keep=False, RATTLEBOX_THREADS=THREADS)
    print(arch, f"{len(compiled.code)} bytes, {compiled.seconds:.1f} s", compiled.spills, compiled.resources)
    assert compiled.resources.keys() == BOUNDS.keys()
    for kernel, most in BOUNDS.items():
        taken = compiled.resources[kernel]
        assert 0 < taken.registers <= most.registers and taken.stack <= most.stack
        assert taken.shared <= most.shared
    assert compiled.spills <= SPILLS


DEM = {  # by architecture: normal law, and friction or rolling; block and grid are compiled alike
    "sm_80": {"RATTLEBOX_NORMAL": 2, "RATTLEBOX_RUBS": 2},
    "sm_90": {"RATTLEBOX_NORMAL": 0, "RATTLEBOX_RUBS": 1},
    "sm_100": {"RATTLEBOX_NORMAL": 1},
}


@pytest.mark.parametrize("arch", ARCHITECTURES)
def test_kernels_of_particles_in_space_are_bounded(arch: str) -> None:
    """With 128 registers four blocks of 128 threads share a multiprocessor; little is spilt."""
    compiled = compile_kernels("dem.cpp", arch, keep=False, **launch_bounds(100), **DEM[arch])
    print(arch, f"{len(compiled.code)} bytes, {compiled.seconds:.1f} s", compiled.spills, compiled.resources)
    assert compiled.resources.keys() == {"block", "grid"}
    for kernel, taken in compiled.resources.items():
        assert 0 < taken.registers <= 128 and taken.stack <= 300
        assert taken.shared <= (9_000 if kernel == "block" else 0)
    assert compiled.spills <= 2000
