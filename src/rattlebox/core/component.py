"""Files of the core for other programs: the headers, and the library with the C interface and the functions of FMUs."""

from __future__ import annotations

import platform
from pathlib import Path

from rattlebox._util.exceptions import ResourceError
from rattlebox.core import _core


def include_dir() -> Path:
    """Return the folder with `rattlebox.h` and the C++ headers of the core.

    Returns
    -------
    Path
        The folder, for the option `-I` of a compiler.

    Raises
    ------
    ResourceError
        If the headers are not installed.

    See Also
    --------
    component_library : The library to link with.

    Examples
    --------
    >>> import rattlebox as rb
    >>> (rb.include_dir() / "rattlebox.h").is_file()
    True
    """
    folders = [folder.parent / "include" for folder in _folders()]
    for folder in (*folders, Path(__file__).parents[3] / "core"):  # the last one in a source checkout
        if (folder / "rattlebox.h").is_file():
            return folder
    raise ResourceError(
        "the headers of the core are not installed", "python -m pip install --force-reinstall rattlebox"
    )


def component_library() -> Path:
    """Return the library with the C interface, which is also the binary of FMUs.

    Returns
    -------
    Path
        A shared library that depends on libc and libm only.

    Raises
    ------
    ResourceError
        On other systems than Linux x86-64.

    See Also
    --------
    include_dir : The folder with its header, `rattlebox.h`.

    Examples
    --------
    >>> import ctypes
    >>> import rattlebox as rb
    >>> library = ctypes.CDLL(str(rb.component_library()))
    """
    for folder in _folders():
        file = folder / "rattlebox_component.so"
        if file.is_file() and platform.system() == "Linux" and platform.machine() == "x86_64":
            return file
    raise ResourceError(
        "FMUs can be written on Linux x86-64 only", "this command on such a machine; the FMU is one file"
    )


def other_libraries() -> dict[str, Path]:
    """Return the libraries for other systems, by the name of the system in FMI 3. They are compiled and were never run."""
    for folder in _folders():
        found = {file.name.split(".")[1]: file for file in sorted(folder.glob("rattlebox_component.*.*"))}
        if found:
            return found
    raise ResourceError(
        "this installation has no libraries for other systems; the wheels for Linux x86-64 have them", "make wheel"
    )


def _folders() -> tuple[Path, Path]:
    """Return the folders of the compiled core and of its Python files, which differ in editable installations."""
    return Path(str(_core.__file__)).parent, Path(__file__).parent
