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


def open3d_scene(o3d, vertices, faces):
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces))
    return scene


def open3d_casts(o3d):
    """Whether its rays hit a square: Debian's 0.16 finds nothing at all on some machines."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    scene = open3d_scene(o3d, square, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    ray = o3d.core.Tensor(np.array([[0.5, 0.25, 2, 0, 0, -1]], np.float32))
    return np.isfinite(scene.cast_rays(ray)["t_hit"].numpy()[0])


@pytest.mark.parametrize("time", [0.0, 0.13, 0.5, 0.99])
def test_hits_are_those_of_open3d(sheet, time):
    o3d = pytest.importorskip("open3d")
    if not open3d_casts(o3d):
        pytest.skip("this Open3D's rays do not even hit a square")
    _, _, model = sheet
    expected = open3d_scene(o3d, model.vertices(time), model.faces).cast_rays(o3d.core.Tensor(rays()))
    ours = RaycastingScene()
    ours.add_triangles(model)
    got = ours.cast_rays(rays(), time=time)
    t = expected["t_hit"].numpy()
    hit = np.isfinite(t)
    assert np.array_equal(hit, np.isfinite(got["t_hit"]))
    assert np.allclose(t[hit], got["t_hit"][hit], rtol=1e-5)
    source = model.source_triangles[expected["primitive_ids"].numpy()[hit]]
    assert (source == got["primitive_ids"][hit]).mean() > 0.98  # but for rays along edges


@pytest.mark.parametrize("time", [0.0, 0.13, 0.5, 0.99])
def test_distances_are_those_of_open3d(sheet, time):
    o3d = pytest.importorskip("open3d")
    _, _, model = sheet
    points = np.random.default_rng(3).uniform(-1, 2, (300, 3)).astype(np.float32)
    theirs = open3d_scene(o3d, model.vertices(time), model.faces)
    ours = RaycastingScene()
    ours.add_triangles(model)
    assert np.allclose(theirs.compute_distance(o3d.core.Tensor(points)).numpy(),
                       ours.compute_distance(points, time=time), rtol=1e-5, atol=1e-6)
