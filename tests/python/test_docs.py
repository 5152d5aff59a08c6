"""The programs in docs/library.md run, and the lidar example finds the hand."""
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(os.environ["MDK_ASSETS"]).parent


def blocks():
    return re.findall(r"```python\n(.*?)```", (ROOT / "docs/library.md").read_text(), re.S)


@pytest.mark.parametrize("number", range(len(blocks())))
def test_programs_in_the_documentation_run(hand, tmp_path, number):
    hand.save(tmp_path / "hand.mdk")
    run = subprocess.run([sys.executable, "-c", blocks()[number]], cwd=tmp_path, capture_output=True,
                         text=True)
    assert run.returncode == 0, run.stderr
    counts = re.findall(r"^(\d+) (?:rays hit|pixels)", run.stdout, re.M)
    assert all(int(count) > 100 for count in counts), run.stdout


def test_lidar_writes_what_its_header_says(hand, tmp_path):
    hand.save(tmp_path / "hand.mdk")
    for name in ("sweep.ply", "sweep.pcd"):
        run = subprocess.run([sys.executable, ROOT / "examples/lidar/lidar.py", "hand.mdk", name],
                             cwd=tmp_path, capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
        count = int(run.stdout.split()[0])
        assert count > 1000
        data = (tmp_path / name).read_bytes()
        end = b"end_header\n" if name.endswith("ply") else b"DATA binary\n"
        body = data[data.index(end) + len(end):]
        assert len(body) == 32 * count
        points = np.frombuffer(body, [(n, "<f4") for n in "xyztd"] + [(n, "<u4") for n in "rai"])
        low, high = hand.bounds
        for k, axis in enumerate("xyz"):
            assert low[k] - 1e-4 <= points[axis].min() and points[axis].max() <= high[k] + 1e-4
        assert points["t"].min() >= 0 and points["t"].max() <= hand.clips[0].seconds
        assert points["r"].max() < 64 and points["a"].max() < 1800 and np.abs(points["d"]).max() > 0
