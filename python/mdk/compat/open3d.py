"""RaycastingScene as in open3d.t.geometry, for one mdk.Model, over NumPy arrays: rays are (..., 6)
float32, origin and direction. Triangles are numbered as in the mesh that was baked; every hit has
geometry_id 0. What is new is `time`: one, or one for each ray."""
import numpy as np

import mdk

_NAMES = ("t", "triangle", "source_triangle", "uv", "normal", "instance")


def _split(rays):
    rays = np.asarray(rays)
    if rays.shape[-1:] != (6,):
        raise ValueError(f"rays has shape {rays.shape}, not (..., 6)")
    return rays[..., :3], rays[..., 3:]


class RaycastingScene:
    INVALID_ID = mdk.MISS

    def __init__(self, nthreads=0):
        self._threads = nthreads
        self._model = None
        self.time, self.clip, self.wrap = 0.0, 0, "once"

    def add_triangles(self, model, triangles=None):
        """Takes an mdk.Model, or vertices (V, 3) or (K, V, 3) and triangles (F, 3). Returns 0."""
        if self._model is not None:
            raise ValueError("this scene has its mesh")
        if triangles is not None:
            vertices = np.asarray(model, np.float32)
            model = mdk.bake(vertices if vertices.ndim == 3 else vertices[None], triangles)
        self._model = model
        return 0

    def _at(self, time):
        if self._model is None:
            raise ValueError("this scene has no mesh: call add_triangles first")
        return dict(time=self.time if time is None else time, clip=self.clip, wrap=self.wrap,
                    threads=self._threads)

    def cast_rays(self, rays, time=None):
        """t_hit, geometry_ids, primitive_ids, primitive_uvs, primitive_normals."""
        at = self._at(time)
        hits = self._model.cast(*_split(rays), want=_NAMES, **at)
        return {"t_hit": hits.t, "geometry_ids": hits.instance,
                "primitive_ids": hits.source_triangle, "primitive_uvs": hits.uv,
                "primitive_normals": hits.normal}

    def test_occlusions(self, rays, tnear=0.0, tfar=float("inf"), time=None):
        """bool (...)."""
        at = self._at(time)
        return self._model.occluded(*_split(rays), t_min=tnear, t_max=tfar, **at)

    def count_intersections(self, rays, time=None):
        """int32 (...)."""
        at = self._at(time)
        return self._model.all_hits(*_split(rays), want=("t",), **at).count.astype(np.int32)

    def list_intersections(self, rays, time=None):
        """ray_ids, ray_splits, t_hit, geometry_ids, primitive_ids, primitive_uvs of all hits."""
        at = self._at(time)
        hits = self._model.all_hits(*_split(rays), want=_NAMES, **at)
        splits = np.concatenate([[0], np.cumsum(hits.count.ravel(), dtype=np.int64)])
        return {"ray_ids": hits.ray, "ray_splits": splits, "t_hit": hits.t,
                "geometry_ids": hits.instance, "primitive_ids": hits.source_triangle,
                "primitive_uvs": hits.uv}

    def compute_closest_points(self, query_points, time=None):
        """points, geometry_ids, primitive_ids, primitive_uvs, primitive_normals."""
        at = self._at(time)
        hits = self._model.closest_point(
            query_points, want=_NAMES + ("position",), **at)
        return {"points": hits.position, "geometry_ids": hits.instance,
                "primitive_ids": hits.source_triangle, "primitive_uvs": hits.uv,
                "primitive_normals": hits.normal}

    def compute_distance(self, query_points, time=None):
        """float32 (...)."""
        at = self._at(time)
        return self._model.closest_point(query_points, want=("t",), **at).t

    @staticmethod
    def create_rays_pinhole(camera):
        """(H, W, 6) float32 of an mdk.Camera."""
        origin, directions = camera.rays()
        return np.concatenate([np.broadcast_to(origin, directions.shape), directions], axis=-1)
