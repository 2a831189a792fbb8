"""Streams depth and colour images to pointreel: from a depth camera, or of a ball that swings.

    send_depth.py [realsense | azure] [--port 8089] [--frames N]

Start it, then `pointreel tcp://127.0.0.1:8089`. A RealSense needs `pip install pyrealsense2 numpy`, an Azure Kinect
`pip install pyk4a`, the ball nothing. The protocol is on docs/live.md.
"""

import argparse
import array
import itertools
import math
import socket
import struct
import threading
import time
import zlib

WIDTH, HEIGHT, FPS = 320, 240, 30


def camera(width, height, fx, fy, cx, cy):
    return struct.pack("<II4dQ8d", width, height, fx, fy, cx, cy, 0, *[0.0] * 8)


def message(number, due_ns, lens, units_per_m, depth, rgb):  # depth: u16, rgb: 3 bytes, of the same pixels
    head = struct.pack("<IIQQQ", 32, number, number, due_ns, due_ns)
    images = struct.pack("<6Id12d", 448, 0, len(depth), 1, len(rgb), 0, units_per_m, *[0.0] * 12)
    payload = head + images + camera(*lens) * 2 + struct.pack("<12d", *[0.0] * 12) + depth + rgb
    return struct.pack("<3I", 1, len(payload), zlib.crc32(payload)) + payload


def realsense():
    import numpy as np, pyrealsense2 as rs

    pipeline, config = rs.pipeline(), rs.config()
    config.enable_stream(rs.stream.depth, 640, 480, rs.format.z16, FPS)
    config.enable_stream(rs.stream.color, 640, 480, rs.format.rgb8, FPS)
    scale_m = pipeline.start(config).get_device().first_depth_sensor().get_depth_scale()
    align = rs.align(rs.stream.color)
    while True:
        frames = align.process(pipeline.wait_for_frames())
        depth, color = frames.get_depth_frame(), frames.get_color_frame()
        of = color.profile.as_video_stream_profile().intrinsics
        lens = (of.width, of.height, of.fx, of.fy, of.ppx, of.ppy)
        yield lens, 1 / scale_m, np.asarray(depth.get_data()).tobytes(), np.asarray(color.get_data()).tobytes()


def azure():
    from pyk4a import CalibrationType, PyK4A

    device = PyK4A()
    device.start()
    of = device.calibration.get_camera_matrix(CalibrationType.COLOR)
    while True:
        capture = device.get_capture()
        depth, color = capture.transformed_depth, capture.color
        lens = (depth.shape[1], depth.shape[0], of[0][0], of[1][1], of[0][2], of[1][2])
        yield lens, 1000, depth.tobytes(), color[:, :, 2::-1].tobytes()  # millimetres; BGRA


def ball():
    lens = (WIDTH, HEIGHT, 300.0, 300.0, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    rays = [((x - lens[4]) / 300, (y - lens[5]) / 300) for y in range(HEIGHT) for x in range(WIDTH)]
    for number in itertools.count():
        across = 0.4 * math.sin(number / 10)
        depth, rgb = array.array("H"), bytearray()
        for x, y in rays:  # distance 1.5 m, radius 0.3 m, before a wall at 2 m
            a, b = x * x + y * y + 1, x * across + 1.5
            root = b * b - a * (across * across + 1.5 * 1.5 - 0.09)
            z = (b - math.sqrt(root)) / a if root > 0 else 2.0
            depth.append(round(1000 * z))
            rgb += bytes((220, 120, 40)) if root > 0 else bytes((90, 100, 110))
        yield lens, 1000, depth.tobytes(), bytes(rgb)


def accepted(server):
    client, _ = server.accept()
    threading.Thread(target=discard, args=(client,), daemon=True).start()
    client.sendall(b"\x89live\r\n\x1a" + struct.pack("<IIQQdQ", 1, 32, time.time_ns(), 0, FPS, time.time_ns()))
    return client, time.monotonic_ns()


def discard(client):
    try:
        while client.recv(4096):
            pass
    except OSError:
        pass


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("source", nargs="?", default="ball", choices=["ball", "realsense", "azure"])
    parser.add_argument("--port", type=int, default=8089)
    parser.add_argument("--frames", type=int)
    asked = parser.parse_args()
    server = socket.create_server(("127.0.0.1", asked.port))
    print(f"pointreel tcp://127.0.0.1:{server.getsockname()[1]}", flush=True)
    frames = itertools.islice({"ball": ball, "realsense": realsense, "azure": azure}[asked.source](), asked.frames)
    for number, images in enumerate(frames):
        if number == 0:
            client, start = accepted(server)
        try:
            client.sendall(message(number, time.monotonic_ns() - start, *images))
        except OSError:  # the viewer has left: the next one begins with the next frame
            client, start = accepted(server)


if __name__ == "__main__":
    main()
