#!/usr/bin/python3
"""A spinning lidar over a moving character (README.md)."""
import argparse

import mdk
import numpy as np

BEAMS, AZIMUTHS = 64, 1800
LOWEST, HIGHEST = -25.0, 15.0  # degrees


def sweep_rays(bounds):
    """Origin (3,) beside the model and directions (AZIMUTHS, BEAMS, 3) of unit length."""
    low, high = bounds.astype(np.float64)
    size = np.linalg.norm(high - low)
    origin = (low + high) / 2 + [0.6 * size, 0.1 * size, 0]
    azimuth = 2 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS
    elevation = np.radians(LOWEST + (HIGHEST - LOWEST) * np.arange(BEAMS) / (BEAMS - 1))
    a, e = azimuth[:, None], elevation[None, :]
    directions = np.stack(np.broadcast_arrays(np.cos(a) * np.cos(e), np.sin(e), np.sin(a) * np.cos(e)), -1)
    return origin.astype(np.float32), directions.astype(np.float32)


def write(path, points):
    """A binary PLY, or PCD, of a structured array."""
    names = points.dtype.names
    with open(path, "wb") as out:
        if path.endswith(".pcd"):
            kinds = [points.dtype[n].kind.upper() for n in names]
            lines = ["VERSION .7", "FIELDS " + " ".join(names),
                     "SIZE " + " ".join(str(points.dtype[n].itemsize) for n in names),
                     "TYPE " + " ".join(kinds), "COUNT " + " ".join("1" for _ in names),
                     f"WIDTH {len(points)}", "HEIGHT 1", "VIEWPOINT 0 0 0 1 0 0 0",
                     f"POINTS {len(points)}", "DATA binary"]
        else:
            kinds = {"f": "float", "u": "uint"}
            lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
            lines += [f"property {kinds[points.dtype[n].kind]} {n}" for n in names] + ["end_header"]
        out.write(("\n".join(lines) + "\n").encode())
        points.tofile(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model")
    parser.add_argument("out", help="a .ply or .pcd file")
    parser.add_argument("--clip", default=0)
    parser.add_argument("--seconds", type=float, help="of a turn; else the clip's")
    options = parser.parse_args()

    model = mdk.load(options.model)
    clip = next((c for c in model.clips if c.name == options.clip), model.clips[0])
    seconds = clip.seconds if options.seconds is None else options.seconds
    origin, directions = sweep_rays(model.bounds)
    times = seconds * np.arange(AZIMUTHS)[:, None] / AZIMUTHS  # a column of beams fires at once

    hits = model.cast(origin, directions, times, clip.name,
                      want=("t", "triangle", "position", "velocity", "instance"), wrap="loop")
    azimuth, ring = np.nonzero(hits.hit)
    points = np.zeros(len(ring), [(n, "<f4") for n in ("x", "y", "z", "time", "doppler")]
                      + [(n, "<u4") for n in ("ring", "azimuth", "instance")])
    points["x"], points["y"], points["z"] = hits.position[hits.hit].T
    points["time"] = times[azimuth, 0]
    v, d = hits.velocity[hits.hit], directions[hits.hit]
    points["doppler"] = v[:, 0] * d[:, 0] + v[:, 1] * d[:, 1] + v[:, 2] * d[:, 2]
    points["ring"], points["azimuth"] = ring, azimuth
    points["instance"] = hits.instance[hits.hit]
    write(options.out, points)
    print(f"{len(points)} of {hits.t.size} rays hit")


if __name__ == "__main__":
    main()
