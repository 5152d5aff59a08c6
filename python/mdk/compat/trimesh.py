"""RayMeshIntersector as in trimesh.ray, for an mdk.Model at a time that may be set, or be one for each
ray. Triangles are numbered as in the mesh that was baked."""
import numpy as np


class RayMeshIntersector:
    def __init__(self, model, time=0.0, clip=0, wrap="once"):
        self.model, self.time, self.clip, self.wrap = model, time, clip, wrap

    def _at(self, time):
        return dict(time=self.time if time is None else time, clip=self.clip, wrap=self.wrap)

    def intersects_any(self, ray_origins, ray_directions, time=None):
        """(N,) bool."""
        return self.model.occluded(ray_origins, ray_directions, **self._at(time))

    def intersects_first(self, ray_origins, ray_directions, time=None):
        """(N,) int64: the triangle that each ray hits first, -1 for none."""
        hits = self.model.cast(ray_origins, ray_directions, want=("triangle", "source_triangle"),
                               **self._at(time))
        return np.where(hits.hit, hits.source_triangle.astype(np.int64), -1)

    def intersects_id(self, ray_origins, ray_directions, return_locations=False,
                      multiple_hits=True, time=None):
        """Triangles (M,) and rays (M,) of all hits, or of the first; with return_locations, (M, 3)
        positions, too."""
        wanted = ("triangle", "source_triangle", "position")
        if multiple_hits:
            hits = self.model.all_hits(ray_origins, ray_directions, want=wanted, **self._at(time))
            index, mask = hits.ray, slice(None)
        else:
            hits = self.model.cast(ray_origins, ray_directions, want=wanted, **self._at(time))
            mask = hits.hit
            index = np.nonzero(mask)[0]
        triangles = hits.source_triangle[mask].astype(np.int64)
        if return_locations:
            return triangles, index, hits.position[mask].astype(np.float64)
        return triangles, index

    def intersects_location(self, ray_origins, ray_directions, multiple_hits=True, time=None):
        """Positions (M, 3), rays (M,) and triangles (M,)."""
        triangles, index, locations = self.intersects_id(
            ray_origins, ray_directions, return_locations=True, multiple_hits=multiple_hits,
            time=time)
        return locations, index, triangles

    def contains_points(self, points, time=None):
        """(N,) bool: inside, of a closed mesh: an odd number of hits along a ray."""
        points = np.asarray(points, np.float32)
        direction = np.array([0.4395064455, 0.617598629942, 0.652231566745], np.float32)
        count = self.model.all_hits(points, direction, want=("t",), **self._at(time)).count
        return count % 2 == 1
