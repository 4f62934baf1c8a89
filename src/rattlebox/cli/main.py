"""Runs the rattlebox command, and hears from the first moment when it is to stop: other modules load later."""

from __future__ import annotations

import gc
import signal
import sys
import weakref
from types import FrameType

from rattlebox.cli.exit_codes import STOPPED

_LOSING = ("__del__", "cb")  # the latter lets go of a lock of importlib
_COMPILED = "ExtensionFileLoader."  # of importlib: modules in C may lose what is raised while they load others


def main() -> None:
    """Run the command; bad input is told on one screen, with exit code 2.

    A command that is stopped keeps what it has; the exit code is then 130 after Ctrl-C and 143 after SIGTERM.
    """
    # The libraries create about 100 000 objects that stay; searching them for garbage again and again takes a tenth of
    # the time of a short command.
    gc.set_threshold(100_000, 20, 20)
    heard: list[int] = []

    def stop(number: int, frame: FrameType | None) -> None:
        if number != signal.SIGALRM:
            heard.append(number)
        if _loses_exceptions(frame):
            signal.setitimer(signal.ITIMER_REAL, 1e-3)  # once more when this is over
        else:
            raise KeyboardInterrupt

    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)
    before = {number: signal.signal(number, stop) for number in numbers if signal.getsignal(number) != signal.SIG_IGN}
    try:
        from rattlebox.cli.commands import carry_out

        carry_out()
    except KeyboardInterrupt:
        sys.stderr.write("stopped\n")
        sys.exit(128 + heard[0])
    except SystemExit as end:
        sys.exit(128 + heard[0] if heard and end.code == STOPPED else end.code)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _loses_exceptions(frame: FrameType | None) -> bool:
    while frame is not None:
        code = frame.f_code
        if code.co_filename == weakref.__file__ or code.co_name in _LOSING or code.co_qualname.startswith(_COMPILED):
            return True
        frame = frame.f_back
    return False
