"""The stand-ins, beside Open3D itself where it is installed."""
import numpy as np
import pytest

from mdk.compat.open3d import RaycastingScene
from mdk.compat.trimesh import RayMeshIntersector


def rays(n=200):
    rng = np.random.default_rng(8)
    rays = np.zeros((n, 6), np.float32)
    rays[:, :2] = rng.uniform(-0.2, 1.2, (n, 2))
    rays[:, 2] = 2
    rays[:, 3:] = rng.uniform(-0.2, 0.2, (n, 3)) - [0, 0, 1]
    return rays


def test_trimesh_names(sheet):
    _, _, model = sheet
    mesh = RayMeshIntersector(model, time=0.4)
    o, d = rays()[:, :3], rays()[:, 3:]
    first = mesh.intersects_first(o, d)
    assert np.array_equal(first >= 0, mesh.intersects_any(o, d))
    triangles, index = mesh.intersects_id(o, d, multiple_hits=False)
    assert np.array_equal(first[index], triangles)
    locations, index, triangles = mesh.intersects_location(o, d)
    assert locations.shape == (len(index), 3) and len(index) >= (first >= 0).sum()


def test_open3d_names(sheet):
    _, _, model = sheet
    scene = RaycastingScene()
    assert scene.add_triangles(model) == 0
    result = scene.cast_rays(rays(), time=0.4)
    hit = np.isfinite(result["t_hit"])
    assert np.array_equal(hit, result["geometry_ids"] == 0)
    assert np.array_equal(hit, scene.test_occlusions(rays(), time=0.4))
    listed = scene.list_intersections(rays(), time=0.4)
    assert listed["ray_splits"][-1] == len(listed["t_hit"])
    assert np.array_equal(np.diff(listed["ray_splits"]), scene.count_intersections(rays(), time=0.4))


@pytest.mark.parametrize("time", [0.0, 0.13, 0.5, 0.99])
def test_hits_are_those_of_open3d(sheet, time):
    o3d = pytest.importorskip("open3d")
    _, faces, model = sheet
    theirs = o3d.t.geometry.RaycastingScene()
    core = o3d.core
    theirs.add_triangles(core.Tensor(model.vertices(time)), core.Tensor(model.faces))
    expected = theirs.cast_rays(core.Tensor(rays()))
    ours = RaycastingScene()
    ours.add_triangles(model)
    got = ours.cast_rays(rays(), time=time)
    t = expected["t_hit"].numpy()
    assert np.array_equal(np.isfinite(t), np.isfinite(got["t_hit"]))
    hit = np.isfinite(t)
    assert np.allclose(t[hit], got["t_hit"][hit], rtol=1e-5)
    source = model.source_triangles[expected["primitive_ids"].numpy()[hit]]
    assert (source == got["primitive_ids"][hit]).mean() > 0.98  # but for rays along edges
    near = theirs.compute_distance(core.Tensor(rays()[:, :3].copy())).numpy()
    assert np.allclose(near, ours.compute_distance(rays()[:, :3], time=time), rtol=1e-5)
