from os import PathLike
from typing import Iterable, List, NamedTuple, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

__version__: str
MISS: int

class Clip(NamedTuple):
    name: str
    seconds: float
    first_key: int
    key_times: npt.NDArray[np.float64]
    bounds: npt.NDArray[np.float32]

class Hits:
    t: npt.NDArray[np.float32]
    triangle: npt.NDArray[np.uint32]
    source_triangle: npt.NDArray[np.uint32]
    uv: npt.NDArray[np.float32]
    position: npt.NDArray[np.float32]
    normal: npt.NDArray[np.float32]
    smooth_normal: npt.NDArray[np.float32]
    velocity: npt.NDArray[np.float32]
    texcoord: npt.NDArray[np.float32]
    material: npt.NDArray[np.uint32]
    base_color: npt.NDArray[np.float32]
    instance: npt.NDArray[np.uint32]
    id: npt.NDArray[np.int64]
    ray: npt.NDArray[np.int64]
    count: npt.NDArray[np.uint32]
    @property
    def hit(self) -> npt.NDArray[np.bool_]: ...

class Camera:
    width: int
    height: int
    fov: float
    def __init__(self, eye: npt.ArrayLike, target: npt.ArrayLike, width: int, height: int,
                 fov: float = ..., up: npt.ArrayLike = ...) -> None: ...
    def rays(self) -> Tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]: ...

class Model:
    @property
    def clips(self) -> List[Clip]: ...
    @property
    def bounds(self) -> npt.NDArray[np.float32]: ...
    @property
    def faces(self) -> npt.NDArray[np.uint32]: ...
    @property
    def source_triangles(self) -> npt.NDArray[np.uint32]: ...
    @property
    def material_colors(self) -> npt.NDArray[np.float32]: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def cluster_count(self) -> int: ...
    @property
    def ray_bytes(self) -> int: ...
    def save(self, path: Union[str, PathLike[str]]) -> None: ...
    def prepare(self) -> None: ...
    def vertices(self, time: npt.ArrayLike = ..., clip: Union[int, str] = ...,
                 wrap: str = ...) -> npt.NDArray[np.float32]: ...
    def cast(self, origins: npt.ArrayLike, directions: npt.ArrayLike, time: npt.ArrayLike = ...,
             clip: Union[int, str] = ..., t_min: npt.ArrayLike = ..., t_max: npt.ArrayLike = ...,
             threads: int = ..., want: Union[str, Iterable[str]] = ..., wrap: str = ...) -> Hits: ...
    def occluded(self, origins: npt.ArrayLike, directions: npt.ArrayLike, time: npt.ArrayLike = ...,
                 clip: Union[int, str] = ..., t_min: npt.ArrayLike = ...,
                 t_max: npt.ArrayLike = ..., threads: int = ...,
                 wrap: str = ...) -> npt.NDArray[np.bool_]: ...
    def all_hits(self, origins: npt.ArrayLike, directions: npt.ArrayLike, time: npt.ArrayLike = ...,
                 clip: Union[int, str] = ..., t_min: npt.ArrayLike = ...,
                 t_max: npt.ArrayLike = ..., threads: int = ...,
                 want: Union[str, Iterable[str]] = ..., wrap: str = ...) -> Hits: ...
    def closest_point(self, points: npt.ArrayLike, time: npt.ArrayLike = ...,
                      radius: npt.ArrayLike = ..., clip: Union[int, str] = ..., threads: int = ...,
                      want: Union[str, Iterable[str]] = ..., wrap: str = ...) -> Hits: ...
    def depth(self, camera: Camera, time: npt.ArrayLike = ..., clip: Union[int, str] = ...,
              threads: int = ..., wrap: str = ...) -> npt.NDArray[np.float32]: ...

def load(path: Union[str, PathLike[str]]) -> Model: ...
def bake(vertices: npt.ArrayLike, faces: npt.ArrayLike, times: Optional[npt.ArrayLike] = ...,
         fps: float = ..., *, clip: str = ..., clusters: int = ..., segments: int = ...,
         quantize: float = ..., threads: int = ...) -> Model: ...
