"""Entry point of the rattlebox command. It installs its signal handlers first and imports the other modules later."""

from __future__ import annotations

import atexit
import gc
import signal
import sys
import weakref
from types import FrameType

from rattlebox.cli.exit_codes import STOPPED

# Finalizers, the callbacks of importlib's locks and compiled modules that import others are not interrupted: most discard
# exceptions, and they would end halfway.
_DISCARDING_FUNCTIONS = ("__del__", "cb")
_DISCARDING_LOADER = "ExtensionFileLoader."
_ALARM = getattr(signal, "SIGALRM", None)
"""Signal that repeats a discarded one; Windows has none, and Ctrl-C must be pressed again."""


def main() -> None:
    """Run the command; print bad input on one screen, with exit code 2.

    A command that is stopped saves its state; the exit code is then 130 after Ctrl-C and 143 after SIGTERM.
    """
    # The libraries create about 100 000 objects that stay alive; repeated searches for garbage among them take a tenth
    # of the time of a short command.
    gc.set_threshold(100_000, 20, 20)
    # Nor is garbage looked for when the program ends, which takes a seventh of the time of a command that draws.
    atexit.unregister(gc.freeze)
    atexit.register(gc.freeze)
    received: list[int] = []

    def stop(number: int, frame: FrameType | None) -> None:
        # The first signal decides the exit code; the alarm only repeats one that came at a bad moment.
        if number != _ALARM:
            received.append(number)
        if _ALARM is not None and _discards_exceptions(frame):
            repeat()
        else:
            raise KeyboardInterrupt

    def repeat() -> None:
        signal.setitimer(signal.ITIMER_REAL, 1e-3)  # by then the function that runs now has returned

    def discarded(event: sys.UnraisableHookArgs) -> None:
        # Compiled code that asks for the type of an object discards exceptions, too.
        if _ALARM is not None and issubclass(event.exc_type, KeyboardInterrupt):
            repeat()
        else:
            hook(event)

    numbers = [signal.SIGINT, signal.SIGTERM, *([] if _ALARM is None else [_ALARM])]
    before = {number: signal.signal(number, stop) for number in numbers if signal.getsignal(number) != signal.SIG_IGN}
    hook, sys.unraisablehook = sys.unraisablehook, discarded
    try:
        from rattlebox.cli.commands import run_command

        run_command()
    except KeyboardInterrupt:
        sys.stderr.write("stopped\n")
        sys.exit(128 + received[0])
    except SystemExit as end:
        sys.exit(128 + received[0] if received and end.code == STOPPED else end.code)
    finally:
        exec("")  # Python ends by SIGINT if the last text that was executed was interrupted
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


def _discards_exceptions(frame: FrameType | None) -> bool:
    """Return whether an exception that is raised in a frame would be lost."""
    while frame is not None:
        code = frame.f_code
        if (
            code.co_filename == weakref.__file__
            or code.co_name in _DISCARDING_FUNCTIONS
            or code.co_qualname.startswith(_DISCARDING_LOADER)
        ):
            return True
        frame = frame.f_back
    return False
