#!/usr/bin/env python3
"""OpenCV's semi-global matching of Middlebury's aloe: what `cargo bench --bench stereo` is compared with.

Usage: opencv_sgbm.py FOLDER OUTPUT.f32 [THREADS]

Prints time and errors of three of its modes, and writes the disparities of the one with eight paths (little-endian
32-bit floats, line by line, -1 where it has none). Needs the packages opencv-python-headless and numpy.
"""

import sys
import time

import cv2
import numpy

folder, output = sys.argv[1:3]
cv2.setNumThreads(int(sys.argv[3]) if len(sys.argv) > 3 else 2)
left, right = (cv2.imread(f"{folder}/aloe{side}.jpg") for side in "LR")
truth = cv2.imread(f"{folder}/aloeGT.png", cv2.IMREAD_GRAYSCALE).astype(float)

window = 5
modes = {
    "eight paths": cv2.STEREO_SGBM_MODE_HH,
    "five paths": cv2.STEREO_SGBM_MODE_SGBM,
    "three paths": cv2.STEREO_SGBM_MODE_SGBM_3WAY,
}
for name, mode in modes.items():
    matcher = cv2.StereoSGBM_create(
        minDisparity=0,
        numDisparities=224,
        blockSize=window,
        P1=8 * 3 * window**2,
        P2=32 * 3 * window**2,
        disp12MaxDiff=1,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=2,
        mode=mode,
    )
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        disparities = matcher.compute(left, right).astype(numpy.float32) / 16
        times.append(time.perf_counter() - begin)
    is_asked = (disparities >= 0) & (truth > 0)
    errors = (disparities - truth)[is_asked]
    signed = numpy.median(errors)
    print(
        f"{name}: {min(times):.2f} s, {100 * is_asked.sum() / (truth > 0).sum():.1f} % answered, "
        f"{100 * (abs(errors) > 2).mean():.2f} % of them beyond 2 px; median error {numpy.median(abs(errors)):.3f} px, "
        f"less the signed median ({signed:.3f}) {numpy.median(abs(errors - signed)):.3f}"
    )
    if name == "eight paths":
        numpy.where(disparities >= 0, disparities, -1).astype("<f4").tofile(output)
