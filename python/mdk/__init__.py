"""Rays against moving meshes, each ray at its own time.

    import mdk
    model = mdk.load("hand.mdk")                      # or mdk.bake(vertices, faces, fps=30)
    hits = model.cast(origins, directions, time=times)
    hits.t, hits.triangle, hits.uv                    # inf and 0xFFFFFFFF where nothing was hit

Coordinates are float32 in the units of the mesh, times are seconds of a clip. Nothing is rebuilt
when time advances, and any number of threads may ask at once: the GIL is released meanwhile.
"""
from ._mdk import version as __version__
from ._model import MISS, Camera, Clip, Hits, Model, bake, load

__all__ = ["MISS", "Camera", "Clip", "Hits", "Model", "bake", "load"]
