"""The compiled core for this processor, under one name; _core.pyi describes it."""

import sys

from rattlebox.core.choose import core

sys.modules[__name__] = core()
