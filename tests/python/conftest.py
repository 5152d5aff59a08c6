import os
import subprocess

import numpy as np
import pytest

import mdk


def waving_sheet(keys=6, n=9, seed=4):
    """A sheet of n x n vertices that waves: (K, V, 3) and (F, 3)."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    k = np.arange(keys)[:, None, None]
    z = 0.2 * np.sin(5 * x + 0.7 * k) * np.cos(3 * y - 0.4 * k)
    vertices = np.stack([np.broadcast_to(x, z.shape), np.broadcast_to(y, z.shape), z], -1)
    vertices = vertices.reshape(keys, n * n, 3).astype(np.float32)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + n + 1], -1), np.stack([i, i + n + 1, i + n], -1)])
    order = np.random.default_rng(seed).permutation(len(faces))
    return vertices, faces[order].astype(np.uint32)


@pytest.fixture(scope="session")
def sheet():
    vertices, faces = waving_sheet()
    return vertices, faces, mdk.bake(vertices, faces, fps=5, clip="wave")


@pytest.fixture(scope="session")
def hand(tmp_path_factory):
    path = tmp_path_factory.mktemp("hand") / "hand.mdk"
    subprocess.run([os.environ["MDPREP"], "bake", os.environ["MDK_ASSETS"] + "/hand.glb", "-o", path,
                    "-q"], check=True)
    return mdk.load(path)
