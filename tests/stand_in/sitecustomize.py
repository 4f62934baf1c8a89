"""Where STAND_IN names its folder, kernels are compiled for the stand-in, in whichever process asks for them."""

from __future__ import annotations

import os
import re
import subprocess
from hashlib import sha256
from pathlib import Path
from time import perf_counter

try:
    from rattlebox.engines import card, gpu
except ModuleNotFoundError:
    gpu = None  # a Python of something else

HERE = Path(__file__).parent
# A card rounds once where processors may round twice; that it computes the same otherwise shows where neither does.
ROUNDING = "-ffp-contract=off" if "STAND_IN_ALIKE" in os.environ else "-march=native -ffp-contract=fast"
FLAGS = f"-std=c++20 -O1 {ROUNDING} -fno-math-errno -fno-exceptions -nostdinc++ -shared -fPIC -w"
TEXT = """
#include "{here}/words.hpp"
#include "{file}"
thread_local char near[227 << 10] __attribute__((aligned(64)));
extern "C" {{
extern const StandInKernel stand_in_kernels[] = {{{kernels}}};
extern const int stand_in_count = sizeof(stand_in_kernels) / sizeof(StandInKernel),
                 stand_in_threads = RATTLEBOX_THREADS, stand_in_blocks = RATTLEBOX_BLOCKS;
char* stand_in_near() {{ return near; }}
}}
"""


def compile_kernels(source: str, arch: str, *, keep: bool = True, **macros: int) -> gpu.Compiled:
    """As rattlebox.engines.gpu.compile_kernels, for the stand-in, and kept in its folder."""
    core, begin = gpu.sources(), perf_counter()
    file = core / "gpu" / source
    named = re.findall(r"__global__.*?void (\w+)\(", file.read_text(encoding="utf-8"), re.DOTALL)
    kernels = ", ".join(f'stand_in("{name}", {name})' for name in named)
    text = TEXT.format(here=HERE, file=file, kernels=kernels)
    given = {"__CUDACC__": 1, "RATTLEBOX_GPU": 1, "RATTLEBOX_BLOCKS": 1, **macros}
    command = [os.environ["STAND_IN_COMPILER"], *FLAGS.split(), *(f"-D{name}={value}" for name, value in given.items())]
    command += ["-I", str(core), "-I", str(core / "gpu" / "std"), "-x", "c++", "-"]
    words = (HERE / "words.hpp").read_bytes()
    library = (
        Path(os.environ["STAND_IN"]) / sha256(repr((command, text, words, gpu._digest(core))).encode()).hexdigest()
    )
    if made := not library.exists():
        subprocess.run([*command, "-o", str(library)], input=text.encode(), check=True)
    return gpu.Compiled(arch, library.read_bytes(), perf_counter() - begin if made else 0.0, {}, 0)


if gpu:
    card.compile_kernels = compile_kernels
