#!/usr/bin/env python3
"""Drags a lamp through a room on an lpvd and watches the light follow. pip install ./client/python"""

import argparse
import threading
import time

import numpy as np

import lpv
from lpv import scene

parser = argparse.ArgumentParser(description="Drags a lamp through a room on an lpvd.")
parser.add_argument("--server", default="localhost:50051", help="HOST:PORT (default: localhost:50051)")
parser.add_argument("--seconds", type=float, default=2.0, help="duration of the drag (default: 2)")
given = parser.parse_args()
below = [(-1.5, 0, 0), (1.5, 0, 0)]

with lpv.connect(given.server) as client:
    session = client.create_session()
    with session.join("dragger") as editor, session.volumes("half") as volumes:
        lamp = scene.light("lamp", scene.quad(0.5), radiance=(20, 18, 14), translation=(-1.5, 2, 0), rotation=(1, 0, 0, 0))
        editor.apply(scene.surface("floor", scene.quad(6)), lamp, scene.fit_grid())
        seen = []
        threading.Thread(target=lambda: seen.extend(volumes), daemon=True).start()
        steps = max(1, int(given.seconds * 60))
        for step in range(1, steps + 1):
            editor.send(scene.change_light("lamp", translation=(-1.5 + 3 * step / steps, 2, 0)), undo_group="drag")
            time.sleep(1 / 60)
        editor.drain(60)
        print(f"{steps} edits acknowledged, {len(editor.refused)} refused, {editor.reopened} reconnections, "
              f"revision {editor.revision}")
        light = session.volume().fluence()[..., 1] ** 4  # the fourth power: where it is brightest
        x = np.average(session.volume().centres()[0], weights=light.sum(axis=(0, 1)))
        kib = sum(volume.received_bytes for volume in seen) / 1024
        print(f"{len(seen)} volumes, {kib:.0f} KiB; brightest at x = {x:.2f} m")
        left, right = session.probe(below).irradiance[:, 1]
        print(f"floor at the drag's start {left:.3f}, at its end {right:.3f} W/m^2")
        editor.undo()
        left, right = session.probe(below).irradiance[:, 1]
        print(f"after undo {left:.3f} and {right:.3f} W/m^2")
    session.delete()
