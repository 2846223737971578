"""Exceptions of octagloss."""


class InputError(OSError, ValueError):
    """A file that is not what it should be: truncated, of a wrong shape, with NaN. The message names it."""


InputError.__module__ = "octagloss"
