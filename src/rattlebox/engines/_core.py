"""The compiled core for this processor, under one name; _core.pyi describes it."""

import sys

from rattlebox.engines.core import core

sys.modules[__name__] = core()
