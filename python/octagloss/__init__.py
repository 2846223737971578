"""Glossy reflections of HDR environments at any roughness, without noise and with certified error bounds.

    >>> import numpy as np, octagloss
    >>> sky = octagloss.Environment.from_array(np.ones((16, 32, 3), np.float32))
    >>> sky.reflect([0, 1, 0], 0.4)
    array([1., 1., 1.], dtype=float32)

Space is right-handed with y up; directions point away from the centre and may have any length but zero.
Radiance is linear RGB. Roughness is perceptual, in [0, 1].

Calls release the interpreter's lock, use all cores (see set_threads), and end at Ctrl-C.
"""

from . import maps
from ._errors import InputError
from ._octagloss import VERSION as __version__
from ._octagloss import Bake, Environment, Level, Sun, bake, dfg, reference, set_threads

__all__ = [
    "Bake",
    "Environment",
    "InputError",
    "Level",
    "Sun",
    "__version__",
    "bake",
    "dfg",
    "maps",
    "reference",
    "set_threads",
]
