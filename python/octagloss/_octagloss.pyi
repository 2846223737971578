from os import PathLike
from typing import Any, Final, List, Literal, Sequence, Tuple, Union, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, PathLike[str]]
_Rgb = Tuple[float, float, float]
_Lobe = Literal["ggx", "phong", "cone", "cosine", "charlie"]
_Layout = Literal["panorama", "cube", "octahedral"]

__all__ = [
    "Bake",
    "Environment",
    "Level",
    "Sun",
    "VERSION",
    "bake",
    "cube_from_direction",
    "dfg",
    "direction_from_cube",
    "direction_from_equirect",
    "direction_from_map",
    "direction_from_oct",
    "equirect_from_direction",
    "map_components",
    "map_density",
    "map_from_direction",
    "map_names",
    "oct_from_direction",
    "reference",
    "set_threads",
]

VERSION: Final[str]

@final
class Sun:
    @property
    def is_sun(self) -> bool: ...
    @property
    def direction(self) -> _Rgb: ...
    @property
    def azimuth_degrees(self) -> float: ...
    @property
    def elevation_degrees(self) -> float: ...
    @property
    def peak(self) -> _Rgb: ...
    @property
    def irradiance(self) -> _Rgb: ...
    @property
    def color(self) -> _Rgb: ...
    @property
    def solid_angle(self) -> float: ...
    @property
    def texels(self) -> int: ...
    @property
    def energy_share(self) -> float: ...
    @property
    def surroundings(self) -> float: ...

@final
class Environment:
    @staticmethod
    def from_file(
        path: Union[_Path, Sequence[_Path]],
        *,
        layout: Literal["auto", "equirect", "cross", "strip", "faces", "octahedral"] = "auto",
        rotate_y: float = 0.0,
        mirror: bool = False,
        scale: float = 1.0,
        crop: bool = False,
        pad: Union[Literal["black", "edge"], None] = None,
        sanitize: bool = False,
        strict: bool = False,
    ) -> Environment: ...
    @staticmethod
    def from_array(
        array: ArrayLike, layout: _Layout = "panorama", *, rotate_y: float = 0.0, mirror: bool = False
    ) -> Environment: ...
    @property
    def layout(self) -> _Layout: ...
    @property
    def shape(self) -> Tuple[int, ...]: ...
    @property
    def texels(self) -> NDArray[np.float32]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def repaired(self) -> dict[str, Any]: ...
    def texel_directions(self) -> Tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def rotated_y(self, degrees: float) -> Environment: ...
    @overload
    def reflect(
        self,
        directions: ArrayLike,
        roughness: Union[ArrayLike, None] = None,
        *,
        lobe: _Lobe = "ggx",
        filter: str = "adaptive:0.005",
        bounds: Literal[False] = False,
        oem_size: Union[int, None] = None,
        border: Union[int, None] = None,
        sharpest: Union[float, None] = None,
    ) -> NDArray[np.float32]: ...
    @overload
    def reflect(
        self,
        directions: ArrayLike,
        roughness: Union[ArrayLike, None] = None,
        *,
        lobe: _Lobe = "ggx",
        filter: str = "adaptive:0.005",
        bounds: Literal[True],
        oem_size: Union[int, None] = None,
        border: Union[int, None] = None,
        sharpest: Union[float, None] = None,
    ) -> Tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    @overload
    def irradiance(
        self,
        normals: ArrayLike,
        *,
        filter: str = "adaptive:0.005",
        bounds: Literal[False] = False,
        oem_size: Union[int, None] = None,
    ) -> NDArray[np.float32]: ...
    @overload
    def irradiance(
        self,
        normals: ArrayLike,
        *,
        filter: str = "adaptive:0.005",
        bounds: Literal[True],
        oem_size: Union[int, None] = None,
    ) -> Tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    def sh(
        self,
        order: int = 2,
        *,
        window: str = "none",
        scale: Literal["radiance", "irradiance", "filament"] = "radiance",
    ) -> NDArray[np.float64]: ...
    def sun(self) -> Union[Sun, None]: ...
    def extract_sun(self) -> Union[Tuple[Environment, Sun], None]: ...
    def extract_suns(self, which: Union[int, str]) -> Tuple[Environment, List[Sun]]: ...

@final
class Level:
    @property
    def roughness(self) -> float: ...
    @property
    def layout(self) -> _Layout: ...
    @property
    def texels(self) -> NDArray[np.float32]: ...
    @property
    def bounds(self) -> Union[NDArray[np.float32], None]: ...
    @property
    def error_bound_max(self) -> Union[float, None]: ...
    @property
    def error_bound_mean(self) -> Union[float, None]: ...
    @property
    def leaves_per_texel(self) -> Union[float, None]: ...

@final
class Bake:
    @property
    def levels(self) -> list[Level]: ...
    @property
    def sheen(self) -> list[Level]: ...
    @property
    def irradiance(self) -> Union[Level, None]: ...
    @property
    def skybox(self) -> Union[Level, None]: ...
    @property
    def sh(self) -> NDArray[np.float64]: ...
    @property
    def oem_size(self) -> int: ...
    @property
    def source_energy(self) -> _Rgb: ...
    @property
    def oem_energy(self) -> _Rgb: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def target(self) -> Union[str, None]: ...
    def write(
        self,
        path: _Path,
        *,
        container: Union[str, None] = None,
        pixel: Union[str, None] = None,
        overflow: Literal["clamp", "compress", "error"] = "clamp",
        name: Union[str, None] = None,
        force: bool = False,
    ) -> None: ...

def bake(
    environment: Environment,
    *,
    size: Union[int, None] = None,
    levels: Union[int, None] = None,
    ladder: Union[Literal["linear", "filament", "unity", "babylon"], None] = None,
    layout: Union[_Layout, None] = None,
    lobe: _Lobe = "ggx",
    filter: str = "adaptive:0.005",
    chain: Union[Literal["sampled", "solved", "mixed"], None] = None,
    bounds: bool = False,
    irradiance: Union[int, None] = None,
    skybox: Union[int, Literal["source"], None] = None,
    sh_order: int = 2,
    sh_window: str = "none",
    oem_size: Union[int, None] = None,
    border: Union[int, None] = None,
    scan: Union[str, None] = None,
    target: Union[str, None] = None,
    flip: Union[Literal["none", "x", "z"], None] = None,
    map: Union[Literal["octahedral", "cube"], None] = None,
    diffuse: Union[Literal["none", "cube", "sh", "both"], None] = None,
    output: Union[_Path, None] = None,
    container: Union[str, None] = None,
    pixel: Union[str, None] = None,
    overflow: Literal["clamp", "compress", "error"] = "clamp",
    name: Union[str, None] = None,
    force: bool = False,
) -> Bake: ...
def dfg(
    size: int = 128,
    *,
    form: Literal["split-sum", "multiple-scattering"] = "split-sum",
    charlie: bool = False,
) -> NDArray[np.float32]: ...
def reference(
    environment: Environment,
    directions: ArrayLike,
    roughness: Union[ArrayLike, None] = None,
    *,
    lobe: _Lobe = "ggx",
) -> NDArray[np.float64]: ...
def set_threads(count: Union[int, None] = None) -> None: ...
def equirect_from_direction(directions: ArrayLike, /) -> NDArray[np.float64]: ...
def direction_from_equirect(uv: ArrayLike, /) -> NDArray[np.float64]: ...
def oct_from_direction(directions: ArrayLike, /) -> NDArray[np.float64]: ...
def direction_from_oct(uv: ArrayLike, /) -> NDArray[np.float64]: ...
def cube_from_direction(directions: ArrayLike, /) -> Tuple[NDArray[np.int64], NDArray[np.float64]]: ...
def direction_from_cube(face: int, uv: ArrayLike, /) -> NDArray[np.float64]: ...
def map_names() -> list[str]: ...
def map_components(name: str) -> list[Tuple[Tuple[float, float], Tuple[float, float]]]: ...
def map_from_direction(
    name: str, directions: ArrayLike, /
) -> Tuple[NDArray[np.int64], NDArray[np.float64]]: ...
def direction_from_map(name: str, uv: ArrayLike, /, component: int = 0) -> NDArray[np.float64]: ...
def map_density(name: str, uv: ArrayLike, /, component: int = 0) -> NDArray[np.float64]: ...
