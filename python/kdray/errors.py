"""What kdray raises.

All of it is an `Error`; each kind is also the exception of Python's own that fits best, so
that ``except ValueError`` works as one would expect.
"""


class Error(Exception):
    """Anything that kdray can't do; the message says what, where, and what to do."""


class InputError(Error, ValueError):
    """An array, a file or a ray that is wrong; the message names the element."""


class UsageError(Error, ValueError):
    """A question or an option that makes no sense here."""


class NoDeviceError(Error, RuntimeError):
    """There is no OpenCL device that kdray can use; `python -m kdray doctor` tells more."""


class OutOfMemoryError(Error, MemoryError):
    """The host or the device has too little memory."""


class CancelledError(Error, RuntimeError):
    """A call that was told to end."""


class InternalError(Error, RuntimeError):
    """A fault of kdray's own: please report it."""
