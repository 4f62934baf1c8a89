"""The compiled core for this processor; _core.pyi has its types."""

import sys

from rattlebox.core.choose import core

sys.modules[__name__] = core()
