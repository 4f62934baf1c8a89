"""Contact laws in C++ of other packages, compiled against the installed headers."""

from __future__ import annotations

import ctypes
import os
from hashlib import sha256
from pathlib import Path

from rattlebox._util.exceptions import DataError
from rattlebox._util.plugins import Registry
from rattlebox.core import _core

_LAWS: Registry[ctypes.CDLL] = Registry("normal law")
"""Loaded libraries by the name of their law; they stay in the process, because the core calls them."""
_digests: dict[str, str] = {}


def load_law(path: str | os.PathLike[str]) -> str:
    """Load a normal contact law from a shared library, for both engines.

    Parameters
    ----------
    path
        The library, compiled from a law and `RATTLEBOX_EXPORT_NORMAL_LAW` in `contact/export_law.hpp`.

    Returns
    -------
    str
        The name of the law, which `Contact.coefficients` of a class in Python returns with its coefficients.

    Raises
    ------
    DataError
        If the file is no such library, or was compiled with the headers of another version.
    ResourceError
        If another law has the name.

    See Also
    --------
    include_dir : Folder with the headers.

    Notes
    -----
    `rattlebox new-law NAME` writes a package with a law, its class and its build, which is ready to be installed.

    Examples
    --------
    >>> import rattlebox as rb
    >>> rb.load_law("law.so")  # doctest: +SKIP
    'hunt_crossley'
    """
    file = os.path.abspath(path)
    advice = "a library that was compiled with the headers in rattlebox.include_dir()"
    try:
        library = ctypes.CDLL(file)
        address = library.rattlebox_normal_law
    except (OSError, AttributeError) as error:
        raise DataError(f"{file} is not a library with a contact law: {error}", advice) from None
    address.restype = ctypes.c_void_p
    try:
        number = _core.add_external_law(address())
    except ValueError as error:
        raise DataError(f"{file}: {error}", advice) from None
    name = _core.external_law_name(number)
    for own in _core.normal_law_names():
        _LAWS.reserve(own, "rattlebox")
    _LAWS.add(name, library, file)
    _digests[name] = sha256(Path(file).read_bytes()).hexdigest()[:12]
    return name


def law_digests() -> dict[str, str]:
    """Return digests of the libraries of all loaded laws, by the names of the laws."""
    return dict(sorted(_digests.items()))
