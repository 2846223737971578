"""Maps of the sphere, for arrays: `..._from_direction` and `direction_from_...`.

The three maps that store environments have functions of their own. The others are named: names() lists them,
components(name) has the rectangles of their coordinates.
"""

from ._octagloss import (
    cube_from_direction,
    direction_from_cube,
    direction_from_equirect,
    direction_from_map,
    direction_from_oct,
    equirect_from_direction,
    map_components as components,
    map_density as density,
    map_from_direction,
    map_names as names,
    oct_from_direction,
)

__all__ = [
    "components",
    "cube_from_direction",
    "density",
    "direction_from_cube",
    "direction_from_equirect",
    "direction_from_map",
    "direction_from_oct",
    "equirect_from_direction",
    "map_from_direction",
    "names",
    "oct_from_direction",
]
