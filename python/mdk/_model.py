"""Model and what it answers with: shapes, names and errors; _mdk does the work."""
import math
import os
from typing import NamedTuple

import numpy as np

from . import _mdk

#: What stands for "no triangle", "no instance" and "no material".
MISS = 0xFFFFFFFF

_WRAPS = {"loop": 0, "once": 1, "ping-pong": 2}
_WANTED = ("t", "triangle", "uv")
_ALL = frozenset(("t", "triangle", "source_triangle", "uv", "position", "normal", "smooth_normal",
                  "velocity", "texcoord", "material", "base_color", "instance", "id"))


class Clip(NamedTuple):
    """A run of keys that are played together."""
    name: str
    seconds: float  #: from 0, its first key, to its last key
    first_key: int  #: among the model's keys
    key_times: np.ndarray  #: (K,) float64, seconds
    bounds: np.ndarray  #: (2, 3) float32: hold the mesh at every time of the clip


class Hits:
    """What rays hit: an array for each name in `want`, of the rays' leading shape.

    t                (...)    float32, inf for a miss; of closest_point() the distance
    triangle         (...)    uint32 into model.faces, 0xFFFFFFFF for a miss
    source_triangle  (...)    uint32: its number in the mesh that was baked
    uv               (..., 2) float32: barycentric coordinates of corners 1 and 2
    position         (..., 3) float32
    normal           (..., 3) float32: the triangle's own, of unit length, outward
    smooth_normal    (..., 3) float32: interpolated between the vertices
    velocity         (..., 3) float32: of the material point, units a second of the clip
    texcoord         (..., 2) float32, as in glTF
    material         (...)    uint32 into model.material_colors
    base_color       (..., 4) float32: linear RGBA, with texture and vertex colours
    instance         (...)    uint32: 0 for a hit of a model
    id               (...)    int64: the user's number of the instance
    ray              (...)    of all_hits(): which ray each hit is of
    """

    def __init__(self, arrays, shape):
        for name, array in arrays.items():
            setattr(self, name, array.reshape(shape + array.shape[1:]))
        self._names = tuple(arrays)

    @property
    def hit(self):
        """Whether there is a hit: bool of the leading shape. Needs t or triangle."""
        if "triangle" in self._names:
            return self.triangle != MISS
        return np.isfinite(self.t)

    def __getattr__(self, name):
        if name in _ALL:
            raise AttributeError(f'{name} was not asked for: cast(…, want=("{name}", …))')
        raise AttributeError(name)

    def __repr__(self):
        return f"<mdk.Hits: {', '.join(self._names)}>"


def _array(value, name, dtype, item=()):
    """`value` as an array of items of shape `item`, without a copy where it is one already."""
    try:
        array = np.asarray(value)
    except Exception as error:
        raise TypeError(f"{name} is no array of numbers") from error
    if array.dtype.kind not in "fiu" and array.size > 0:
        raise TypeError(f"{name} is an array of {array.dtype}, not of real numbers")
    if item and array.shape[-len(item):] != item:
        wanted = ", ".join(["...", *map(str, item)])
        raise ValueError(f"{name} has shape {array.shape}, not ({wanted})")
    with np.errstate(over="ignore"):
        return array.astype(dtype, copy=False)


def _spread(arrays, names, items):
    """The leading shape that all have in common, and each as rows or as one item for all."""
    leads = [a.shape[:a.ndim - len(item)] for a, item in zip(arrays, items)]
    try:
        shape = np.broadcast_shapes(*leads)
    except ValueError:
        listed = ", ".join(f"{n} {lead}" for n, lead in zip(names, leads))
        raise ValueError(f"these leading shapes do not go together: {listed}") from None
    count = math.prod(shape)
    if count >= 1 << 32:
        raise ValueError(f"{names[0]}: {count} of them are more than 2^32 - 1")
    rows = []
    for array, item, lead in zip(arrays, items, leads):
        if math.prod(lead) == 1:
            rows.append(np.ascontiguousarray(array).reshape(item))
            continue
        if lead != shape:
            array = np.broadcast_to(array, shape + item)
        array = array.reshape((count,) + item)
        if item and array.strides[-1] != array.itemsize:
            array = np.ascontiguousarray(array)
        rows.append(array)
    return shape, count, rows


def _threads(threads):
    if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)) or threads < 0:
        raise ValueError(f"threads is {threads!r}, not a number of threads (0: all cores)")
    return min(int(threads), 1 << 16)


def _names(want):
    names = (want,) if isinstance(want, str) else tuple(want)
    for name in names:
        if name not in _ALL:
            raise ValueError(f"want: there is no {name!r}, but {', '.join(sorted(_ALL))}")
    return names


def load(path):
    """Maps a .mdk file, which must not change while the model lives.

    OSError where it cannot be read, ValueError where it is no .mdk file or damaged.
    """
    return Model(_mdk.Model.load(os.fspath(path)))


def bake(vertices, faces, times=None, fps=30.0, *, clip="clip", clusters=0, segments=0, quantize=0.0,
         threads=0):
    """Splits the motion of a mesh into clusters and builds structures that hold at every time.

    vertices  (K, V, 3) float32: every vertex at every key, finite
    faces     (F, 3) integers below V, counter-clockwise seen from outside
    times     (K,) seconds of the keys, rising; None: keys at `fps`
    clusters, segments: exactly so many; 0: as many as pay
    quantize  positions may be so far off, in rest pose diagonals; 0: exact

    Triangles and vertices of the model are reordered, and vertices that move alike are joined:
    hits' source_triangle, with the same uv, leads back to `faces`. ValueError names what is wrong.
    Cost: seconds for 10^4 triangles and 100 keys; the GIL is released.
    """
    vertices = _array(vertices, "vertices", np.float32)
    if vertices.ndim != 3 or vertices.shape[2] != 3:
        raise ValueError(f"vertices has shape {vertices.shape}, not (keys, vertices, 3)")
    corners = np.asarray(faces)
    if corners.dtype.kind not in "iu" and corners.size > 0:
        raise TypeError(f"faces is an array of {corners.dtype}, not of integers")
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise ValueError(f"faces has shape {corners.shape}, not (faces, 3)")
    if corners.size and (corners.min() < 0 or corners.max() >= vertices.shape[1]):
        raise ValueError(f"faces names vertex {corners.min() if corners.min() < 0 else corners.max()}"
                         f" of {vertices.shape[1]}")
    if times is not None:
        times = _array(times, "times", np.float64)
        if times.shape != vertices.shape[:1]:
            raise ValueError(f"times has shape {times.shape}, not ({vertices.shape[0]},)")
        times = np.ascontiguousarray(times)
    for name, number in (("clusters", clusters), ("segments", segments)):
        if isinstance(number, bool) or not isinstance(number, (int, np.integer)) \
                or not 0 <= number < 1 << 32:
            raise ValueError(f"{name} is {number!r}, not a count")
    return Model(_mdk.Model.bake(np.ascontiguousarray(vertices),
                                 np.ascontiguousarray(corners, np.uint32), times, float(fps),
                                 str(clip), int(clusters), int(segments), float(quantize),
                                 _threads(threads)))


class Camera:
    """A pinhole camera: `eye` looks at `target`, with `up` (y) up and `fov` degrees from the lower
    to the upper edge of width x height pixels."""

    def __init__(self, eye, target, width, height, fov=45.0, up=(0.0, 1.0, 0.0)):
        self.eye = _array(eye, "eye", np.float64, (3,))
        self.target = _array(target, "target", np.float64, (3,))
        self.up = _array(up, "up", np.float64, (3,))
        self.width, self.height, self.fov = int(width), int(height), float(fov)
        if self.width < 1 or self.height < 1:
            raise ValueError(f"a camera of {width} x {height} pixels")
        if not 0 < self.fov < 180:
            raise ValueError(f"fov is {fov}, not between 0 and 180 degrees")

    def rays(self):
        """Origins (3,) and directions (H, W, 3) float32 through the pixels' centres, row 0 on top.
        Directions have length 1 along the view: t is the depth."""
        forward = self.target - self.eye
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, self.up)
        right /= np.linalg.norm(right)
        up = np.cross(right, forward)
        half = math.tan(math.radians(self.fov) / 2)
        y = (1 - (2 * np.arange(self.height) + 1) / self.height) * half
        x = ((2 * np.arange(self.width) + 1) / self.width - 1) * half * self.width / self.height
        directions = forward + y[:, None, None] * up + x[None, :, None] * right
        return self.eye.astype(np.float32), directions.astype(np.float32)


class Model:
    """An animated mesh with structures that hold at every time. Made by load() and bake(). Nothing
    changes it; any number of threads may use it.

    Each method below takes `time` in seconds of `clip` (its number or name); `wrap` says what becomes
    of times outside of it: "once" (stands at the first or last key), "loop" or "ping-pong".
    """

    def __init__(self, model):
        self._model = model
        self._info = model.info()
        self._clips = [Clip(*model.clip(i)) for i in range(self._info["clips"])]

    @property
    def clips(self):
        """The clips, a list of Clip."""
        return list(self._clips)

    @property
    def bounds(self):
        """(2, 3) float32: the corners of a box that holds the mesh at every time."""
        return self._info["bounds"].copy()

    @property
    def faces(self):
        """(F, 3) uint32: vertices of the triangles' corners, counter-clockwise from outside."""
        return self._model.faces()

    @property
    def source_triangles(self):
        """(F,) uint32: the number that each triangle had in the mesh that was baked."""
        return self._model.source_triangles()

    @property
    def material_colors(self):
        """(M, 4) float32: linear RGBA, without textures and vertex colours."""
        return self._model.material_colors()

    @property
    def vertex_count(self):
        return self._info["vertices"]

    @property
    def triangle_count(self):
        return self._info["triangles"]

    @property
    def cluster_count(self):
        return self._info["clusters"]

    @property
    def ray_bytes(self):
        """Bytes that rays need at present, beside the mapped file."""
        return self._model.ray_bytes()

    def __repr__(self):
        return (f"<mdk.Model: {self.triangle_count} triangles, {self._info['keys']} keys, clips "
                f"{', '.join(c.name for c in self._clips)}>")

    def save(self, path):
        """Writes a .mdk file, whole or not at all. OSError where it cannot."""
        self._model.save(os.fspath(path))

    def prepare(self):
        """Builds what rays need, which else the first cast does."""
        self._model.prepare()

    def _clip(self, clip):
        if isinstance(clip, str):
            for i, known in enumerate(self._clips):
                if known.name == clip:
                    return i
            raise ValueError(f"clip: there is no {clip!r}, but "
                             + ", ".join(repr(c.name) for c in self._clips))
        if isinstance(clip, bool) or not isinstance(clip, (int, np.integer)) \
                or not 0 <= clip < len(self._clips):
            raise ValueError(f"clip {clip!r} is not among the model's {len(self._clips)} clips")
        return int(clip)

    @staticmethod
    def _wrap(wrap):
        if wrap not in _WRAPS:
            raise ValueError(f"wrap is {wrap!r}, not one of {', '.join(_WRAPS)}")
        return _WRAPS[wrap]

    def vertices(self, time=0.0, clip=0, wrap="once"):
        """Where the vertices are, as they are traced: (..., V, 3) float32 for times (...)."""
        times = _array(time, "time", np.float64)
        clip, wrap = self._clip(clip), self._wrap(wrap)
        if times.ndim == 0:
            return self._model.vertices(clip, float(times), wrap)
        poses = [self._model.vertices(clip, float(t), wrap) for t in times.ravel()]
        return np.array(poses, np.float32).reshape(times.shape + (self.vertex_count, 3))

    def _rays(self, origins, directions, time, clip, wrap, t_min, t_max, threads):
        names = ("origins", "directions", "t_min", "t_max", "time")
        items = ((3,), (3,), (), (), ())
        types = (np.float32, np.float32, np.float32, np.float32, np.float64)
        arrays = [_array(a, n, d, i) for a, n, d, i in
                  zip((origins, directions, t_min, t_max, time), names, types, items)]
        shape, count, rows = _spread(arrays, names, items)
        return shape, count, _mdk.RayLists(count, *rows, self._clip(clip), self._wrap(wrap),
                                           _threads(threads))

    def cast(self, origins, directions, time=0.0, clip=0, t_min=0.0, t_max=math.inf, threads=0,
             want=_WANTED, wrap="once"):
        """The closest hit of each ray at its own time: Hits with the arrays named in `want`.

        origins, directions  (..., 3) float32; t counts in lengths of the direction
        time, t_min, t_max   (...); all leading shapes are broadcast
        threads              of this call; 0: all cores

        Arrays of float32 whose rows are contiguous are not copied. ValueError or TypeError names
        the argument that is wrong (shape, type, NaN, infinity, clip, wrap).
        """
        want = _names(want)
        shape, _, rays = self._rays(origins, directions, time, clip, wrap, t_min, t_max, threads)
        return Hits(self._model.cast(rays, want), shape)

    def occluded(self, origins, directions, time=0.0, clip=0, t_min=0.0, t_max=math.inf, threads=0,
                 wrap="once"):
        """Whether each ray hits anything: bool (...). Cheaper than cast()."""
        shape, _, rays = self._rays(origins, directions, time, clip, wrap, t_min, t_max, threads)
        return self._model.occluded(rays).astype(bool).reshape(shape)

    def all_hits(self, origins, directions, time=0.0, clip=0, t_min=0.0, t_max=math.inf, threads=0,
                 want=_WANTED, wrap="once"):
        """Every hit of every ray, ray by ray, the nearest first: Hits of shape (N,), with `ray`,
        which ray (flattened) each is of, and `count` (...), how many each ray has."""
        want = _names(want)
        shape, count, rays = self._rays(origins, directions, time, clip, wrap, t_min, t_max, threads)
        per_ray = 4
        counts, arrays = self._model.all_hits(rays, per_ray, want)
        if count and counts.max() > per_ray:
            per_ray = int(counts.max())
            if per_ray * count >= 1 << 32:
                raise ValueError("origins: too many rays for the hits they have")
            counts, arrays = self._model.all_hits(rays, per_ray, want)
        used = (np.arange(per_ray) < counts[:, None]).ravel()
        arrays = {name: array[used] for name, array in arrays.items()}
        arrays["ray"] = np.repeat(np.arange(count, dtype=np.int64), counts)
        hits = Hits(arrays, (int(used.sum()),))
        hits.count = counts.reshape(shape)
        return hits

    def closest_point(self, points, time=0.0, radius=math.inf, clip=0, threads=0,
                      want=("t", "triangle", "uv", "position"), wrap="once"):
        """The closest point of the mesh to each point (..., 3), not farther than `radius` (...):
        Hits, whose t is the distance."""
        want = _names(want)
        names, items = ("points", "radius", "time"), ((3,), (), ())
        arrays = [_array(a, n, d, i) for a, n, d, i in
                  zip((points, radius, time), names, (np.float32, np.float32, np.float64), items)]
        shape, count, rows = _spread(arrays, names, items)
        return Hits(self._model.closest_points(count, *rows, self._clip(clip), self._wrap(wrap),
                                               _threads(threads), want), shape)

    def depth(self, camera, time=0.0, clip=0, threads=0, wrap="once"):
        """How far the mesh is, along the view of a Camera: (H, W) float32, inf where it is not.
        `time`: one, or one a row (H,): a rolling shutter, or (H, W)."""
        origin, directions = camera.rays()
        times = _array(time, "time", np.float64)
        if times.ndim == 1:
            if times.shape != (camera.height,):
                raise ValueError(f"time has shape {times.shape}, not ({camera.height},): one a row")
            times = times[:, None]
        return self.cast(origin, directions, times, clip, threads=threads, want=("t",), wrap=wrap).t
