"""Hits against a Möller-Trumbore in double over NumPy, and the other promises of the docstrings."""
import subprocess
import sys
import threading

import numpy as np
import pytest

import mdk

WANT = ("t", "triangle", "source_triangle", "uv", "position", "normal", "velocity", "instance")


def pose(vertices, fps, time):
    """The sheet's vertices at a time, straight lines between keys."""
    k = np.clip(time * fps, 0, len(vertices) - 1)
    k0 = np.minimum(int(k), len(vertices) - 2)
    return vertices[k0] + (vertices[k0 + 1] - vertices[k0]).astype(np.float64) * (k - k0)


def intersect(origin, direction, corners):
    """t, face, u, v of the nearest hit; inf and -1 for none; corners (F, 3, 3)."""
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(direction, e2)
    det = np.einsum("ij,ij->i", e1, p)
    s = origin - a
    u = np.einsum("ij,ij->i", s, p) / det
    q = np.cross(s, e1)
    v = q @ direction / det
    t = np.einsum("ij,ij->i", e2, q) / det
    t = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), t, np.inf)
    best = np.argmin(t)
    return (t[best], best, u[best], v[best]) if np.isfinite(t[best]) else (np.inf, -1, 0, 0)


def rays(n, seed=1):
    rng = np.random.default_rng(seed)
    origins = rng.uniform(-0.2, 1.2, (n, 3)).astype(np.float32)
    origins[:, 2] = 2
    directions = (rng.uniform(-0.3, 0.3, (n, 3)) - [0, 0, 1]).astype(np.float32)
    return origins, directions, rng.uniform(0, 1, n)


def test_hits_are_those_of_moeller_and_trumbore(sheet):
    vertices, faces, model = sheet
    origins, directions, times = rays(400)
    hits = model.cast(origins, directions, times, want=WANT)
    assert 100 < hits.hit.sum() < 400
    for i in range(len(times)):
        corners = pose(vertices, 5, times[i])[faces]
        t, face, u, v = intersect(origins[i].astype(float), directions[i].astype(float), corners)
        assert np.isclose(hits.t[i], t, rtol=1e-5) or (np.isinf(t) and np.isinf(hits.t[i]))
        if face < 0:
            assert hits.triangle[i] == hits.source_triangle[i] == hits.instance[i] == mdk.MISS
            continue
        assert hits.source_triangle[i] == face or min(u, v, 1 - u - v) < 1e-4
        if hits.source_triangle[i] == face:
            assert np.allclose(hits.uv[i], (u, v), atol=1e-3)
            moved = (pose(vertices, 5, times[i] + 1e-6) - pose(vertices, 5, times[i] - 1e-6)) / 2e-6
            expected = np.array([1 - u - v, u, v]) @ moved[faces[face]]
            assert np.allclose(hits.velocity[i], expected, atol=2e-3)
        assert np.allclose(hits.position[i], origins[i] + hits.t[i] * directions[i], atol=1e-4)
        assert np.isclose(np.linalg.norm(hits.normal[i]), 1, atol=1e-5)


def test_every_other_question_agrees_with_the_closest_hit(sheet):
    _, _, model = sheet
    origins, directions, times = rays(300, seed=2)
    hits = model.cast(origins, directions, times)
    assert np.array_equal(model.occluded(origins, directions, times), hits.hit)
    all_hits = model.all_hits(origins, directions, times)
    assert np.array_equal(all_hits.count > 0, hits.hit)
    first = (np.cumsum(all_hits.count) - all_hits.count).astype(int)[hits.hit]
    assert np.array_equal(all_hits.t[first], hits.t[hits.hit])
    assert np.array_equal(all_hits.ray[first], np.nonzero(hits.hit)[0])
    on = model.cast(origins, directions, times, want=("t", "position"))
    near = model.closest_point(on.position[hits.hit], times[hits.hit])
    assert near.t.max() < 1e-6


def test_many_hits_of_one_ray_are_all_there():
    layers = np.arange(10, dtype=np.float32)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    vertices = (square + layers[:, None, None] * [0, 0, 1]).reshape(1, 40, 3)
    faces = np.concatenate([np.array([[0, 1, 2], [0, 2, 3]]) + 4 * i for i in range(10)])
    model = mdk.bake(vertices, faces)
    hits = model.all_hits([[0.7, 0.2, -1], [5, 5, -1]], [0, 0, 1])
    assert hits.count.tolist() == [10, 0]
    assert np.allclose(hits.t, np.arange(10) + 1)


def test_shapes_are_broadcast(sheet):
    _, _, model = sheet
    origin = np.array([0.5, 0.5, 2], np.float32)
    hits = model.cast(origin, [0, 0, -1], np.linspace(0, 1, 12).reshape(3, 4), want=("t", "uv"))
    assert hits.t.shape == (3, 4) and hits.uv.shape == (3, 4, 2)
    one = model.cast(origin, [0, 0, -1])
    assert one.t.shape == () and one.t == model.cast(origin, [0, 0, -1], 0.0).t
    assert model.cast(np.zeros((0, 3)), [0, 0, 1]).t.shape == (0,)
    # Views with steps, other types, and orders of memory give the same.
    origins, directions, times = rays(64)
    expected = model.cast(origins, directions, times)
    wide = np.zeros((64, 6), np.float32)
    wide[:, :3], wide[:, 3:] = origins, directions
    for o, d, t in ((wide[:, :3], wide[:, 3:], times), (origins.astype(float), directions, times),
                    (np.asfortranarray(origins), directions, np.repeat(times, 2)[::2]),
                    (origins[::-1][::-1], directions.tolist(), times.tolist())):
        got = model.cast(o, d, t)
        assert np.array_equal(got.t, expected.t) and np.array_equal(got.triangle, expected.triangle)
    assert np.array_equal(model.cast(origins, directions, times, threads=1).t, expected.t)


def test_times_beyond_the_clip(sheet):
    _, _, model = sheet
    assert np.array_equal(model.vertices(9.0), model.vertices(1.0))
    assert np.array_equal(model.vertices(1.25, wrap="loop"), model.vertices(0.25))
    assert np.array_equal(model.vertices(1.25, wrap="ping-pong"), model.vertices(0.75))
    assert model.vertices([0, 0.5]).shape == (2, model.vertex_count, 3)
    assert model.clips[0].name == "wave" and model.clips[0].seconds == 1.0
    assert np.allclose(model.clips[0].key_times, np.arange(6) / 5)


def test_bakes_survive_a_file(sheet, tmp_path):
    _, _, model = sheet
    model.save(tmp_path / "sheet.mdk")
    loaded = mdk.load(tmp_path / "sheet.mdk")
    origins, directions, times = rays(100)
    assert np.array_equal(loaded.cast(origins, directions, times).t,
                          model.cast(origins, directions, times).t)
    assert np.array_equal(loaded.faces, model.faces)
    assert np.array_equal(loaded.bounds, model.bounds)


def test_faces_and_source_triangles_lead_back(sheet):
    vertices, faces, model = sheet
    assert np.array_equal(model.vertices(0)[model.faces], vertices[0][faces[model.source_triangles]])


def test_depth_of_a_rolling_shutter_is_that_of_each_row(hand):
    low, high = hand.bounds
    center = (low + high) / 2
    camera = mdk.Camera(center + [0, 0, 0.3], center, 40, 30)
    times = np.linspace(0, 0.3, 30)
    depth = hand.depth(camera, times)
    assert depth.shape == (30, 40) and 100 < np.isfinite(depth).sum() < 1200
    for row in (0, 13, 29):
        assert np.array_equal(depth[row], hand.depth(camera, times[row])[row])


@pytest.mark.parametrize("call, name", [
    (lambda m: m.cast([0, 0, np.nan], [0, 0, 1]), "origins"),
    (lambda m: m.cast([0, 0, 0], [0, np.inf, 1]), "directions"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], np.nan), "times"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], t_max=np.nan), "t_max"),
    (lambda m: m.cast([0, 0], [0, 0, 1]), "origins"),
    (lambda m: m.cast(np.zeros((3, 3)), np.ones((2, 3))), "directions"),
    (lambda m: m.cast(np.zeros((3, 3)), [0, 0, 1], np.zeros(2)), "time"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], clip=7), "clip 7"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], clip="run"), "clip"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], wrap="twice"), "wrap"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], threads=-1), "threads"),
    (lambda m: m.cast([0, 0, 0], [0, 0, 1], want=("colour",)), "want"),
    (lambda m: m.cast(np.broadcast_to(np.float32(0), (1 << 16, 1 << 16, 3)), [0, 0, 1]), "origins"),
    (lambda m: m.closest_point([np.nan, 0, 0]), "points"),
    (lambda m: m.closest_point([0, 0, 0], radius=np.nan), "radii"),
    (lambda m: mdk.bake(np.zeros((2, 3)), [[0, 1, 2]]), "vertices"),
    (lambda m: mdk.bake(np.full((1, 3, 3), np.nan), [[0, 1, 2]]), "vertices"),
    (lambda m: mdk.bake(np.zeros((1, 3, 3)), [[0, 1, 3]]), "faces"),
    (lambda m: mdk.bake(np.zeros((1, 3, 3)), [[0, 1, -1]]), "faces"),
    (lambda m: mdk.bake(np.zeros((2, 3, 3)), [[0, 1, 2]], times=[1, 1]), "times"),
    (lambda m: mdk.bake(np.zeros((2, 3, 3)), [[0, 1, 2]], fps=0), "fps"),
    (lambda m: mdk.bake(np.zeros((0, 3, 3)), [[0, 1, 2]]), "keys"),
    (lambda m: mdk.Camera([0, 0, 0], [0, 0, 1], 0, 4), "0 x 4"),
])
def test_errors_name_the_argument(sheet, call, name):
    with pytest.raises(ValueError, match=name):
        call(sheet[2])


def test_wrong_types_are_type_errors(sheet):
    for bad in (["a", "b", "c"], np.zeros(3, complex), np.zeros(3, bool), [None, 0, 1]):
        with pytest.raises(TypeError, match="origins"):
            sheet[2].cast(bad, [0, 0, 1])
    with pytest.raises(TypeError, match="faces"):
        mdk.bake(np.zeros((1, 3, 3)), [[0.0, 1.0, 2.0]])
    with pytest.raises(AttributeError, match="normal was not asked for"):
        sheet[2].cast([0, 0, 0], [0, 0, 1]).normal


def test_files_that_cannot_be_read_are_errors(tmp_path):
    with pytest.raises(OSError):
        mdk.load(tmp_path / "none.mdk")
    (tmp_path / "bad.mdk").write_bytes(b"no model")
    with pytest.raises(ValueError):
        mdk.load(tmp_path / "bad.mdk")


def test_threads_share_a_model(sheet):
    origins, directions, times = rays(3000, seed=5)
    vertices, faces, _ = sheet
    model = mdk.bake(vertices, faces, fps=5)
    results = [None] * 4

    def work(i):
        results[i] = model.cast(origins, directions, times, threads=1).t

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(r, results[0]) for r in results)


def test_import_brings_numpy_alone():
    code = ("import sys, numpy; before = set(sys.modules); import mdk; "
            "print(sorted(m for m in set(sys.modules) - before if m.split('.')[0] not in sys.stdlib_module_names | {'mdk'}))")
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"
