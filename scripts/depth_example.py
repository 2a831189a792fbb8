"""Makes an organised cloud (PCD) of the aloe of Middlebury 2006, as OpenCV has it: every third pixel.

    depth_example.py FOLDER OUTPUT.pcd

FOLDER has aloeL.jpg and aloeGT.png. Disparities are those of the full size: the focal length is 3740 pixels, the
baseline 0.16 m, and 270 pixels were cut off (https://vision.middlebury.edu/stereo/data/scenes2006/).
"""

import sys

import numpy as np
from PIL import Image

FOCAL_PX = 3740.0
BASELINE_M = 0.16
CUT_PX = 270.0
STEP = 3


def main() -> None:
    folder, output = sys.argv[1:]
    disparity = np.asarray(Image.open(f"{folder}/aloeGT.png").convert("L"), dtype=float)
    picture = np.asarray(Image.open(f"{folder}/aloeL.jpg").convert("RGB"), dtype=np.uint32)
    height, width = disparity.shape
    rows, columns = np.mgrid[0:height:STEP, 0:width:STEP]
    chosen = disparity[rows, columns]
    depth = np.where(chosen > 0, BASELINE_M * FOCAL_PX / (chosen + CUT_PX), np.nan)
    x = (columns - 0.5 * width) / FOCAL_PX * depth
    y = (rows - 0.5 * height) / FOCAL_PX * depth
    red, green, blue = (picture[rows, columns, channel] for channel in range(3))
    points = np.empty(rows.shape, dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])
    points["x"], points["y"], points["z"] = x, y, depth
    points["rgb"] = red << 16 | green << 8 | blue
    lines = [
        "VERSION .7",
        "FIELDS x y z rgb",
        "SIZE 4 4 4 4",
        "TYPE F F F U",
        "COUNT 1 1 1 1",
        f"WIDTH {rows.shape[1]}",
        f"HEIGHT {rows.shape[0]}",
        "VIEWPOINT 0 0 0 1 0 0 0",
        f"POINTS {points.size}",
        "DATA binary",
        "",
    ]
    with open(output, "wb") as file:
        file.write("\n".join(lines).encode())
        file.write(points.tobytes())


if __name__ == "__main__":
    main()
