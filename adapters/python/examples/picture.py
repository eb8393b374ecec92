# SPDX-License-Identifier: Apache-2.0
"""Pictures of scenes, fields and histograms as PNG files, by NumPy and the library's own rays."""

from __future__ import annotations

import argparse
import struct
import zlib
from pathlib import Path

import numpy as np
import raycontact as rc

COLOURS = np.array([(214, 98, 52), (58, 124, 190), (222, 176, 70), (80, 158, 92), (150, 96, 174), (172, 168, 158)])
GREY = len(COLOURS) - 1


def options(description: str) -> argparse.ArgumentParser:
    """What all examples take."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--picture", metavar="FILE.png", help="draws what was found")
    parser.add_argument("--page", metavar="FILE.html", help="writes a page to turn it in (needs viser)")
    return parser


def save(file: str, image: np.ndarray) -> None:
    """Writes an image (h, w, 3), 0 to 255."""
    pixels = np.clip(image + 0.5, 0, 255).astype(np.uint8)
    height, width = pixels.shape[:2]
    lines = np.c_[np.zeros(height, np.uint8), pixels.reshape(height, -1)].tobytes()
    header = struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    parts = [struct.pack(">I", len(d)) + k + d + struct.pack(">I", zlib.crc32(k + d)) for k, d in chunks]
    Path(file).write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))
    print(f"picture: {file}")


def look(scene: rc.Scene) -> tuple[np.ndarray, np.ndarray]:
    """An eye from which all of a scene is seen, and the middle that it looks at; metres."""
    placed = zip((scene.shape(body).vertices for body in scene.ids), scene.poses())
    points = np.concatenate([vertices @ pose[:3, :3].T + pose[:3, 3] for vertices, pose in placed])
    low, high = points.min(axis=0), points.max(axis=0)
    return (low + high) / 2 + np.linalg.norm(high - low) * np.array((0.4, -1.0, 0.8)), (low + high) / 2


def draw(scene: rc.Scene, eye: np.ndarray, at: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """The scene as seen from `eye` towards `at`, metres, z up, with the last step's contacts as dots: (450, 720, 3).

    colours: (n,), a row of COLOURS for each body, by slot. Each pixel is the mean of four rays."""
    width, height = 720, 450
    ahead = np.subtract(at, eye) / np.linalg.norm(np.subtract(at, eye))
    right = np.cross(ahead, (0, 0, 1)) / np.linalg.norm(np.cross(ahead, (0, 0, 1)))
    up = np.cross(right, ahead)
    x, y = np.meshgrid(np.arange(2 * width) - width + 0.5, height - np.arange(2 * height) - 0.5)
    rays = (ahead + 0.36 / height * (x[..., None] * right + y[..., None] * up)).reshape(-1, 3)
    hits = scene.raycast(np.asarray(eye, float), rays)
    sun = np.array((-0.3, -0.5, 0.8)) / np.linalg.norm((-0.3, -0.5, 0.8))
    light = 0.55 + 0.45 * np.clip(hits.normal @ sun, -0.6, 1)
    met = hits.body >= 0
    image = np.full((len(rays), 3), 252.0)
    slots = np.searchsorted(scene.ids, hits.body[met])
    image[met] = COLOURS[np.asarray(colours)[slots]] * light[met, None]
    image = image.reshape(2 * height, 2 * width, 3)
    points = scene.contacts.touching.point_a - eye
    away = points @ ahead
    for u, v in np.c_[points @ right / away, points @ up / away][away > 0] / (0.36 / height):
        row, column = int(height - v), int(width + u)
        image[max(row - 3, 0) : max(row + 4, 0), max(column - 3, 0) : max(column + 4, 0)] = (190, 0, 30)
    return image.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))


def heat(values: np.ndarray) -> np.ndarray:
    """(h, w) values as an image: blue below 0, red above, a black line at 0."""
    share = np.clip(np.abs(values) / np.abs(values).max(), 0, 1)[..., None] ** 0.6
    image = 255 + share * (np.where(values[..., None] < 0, (40, 90, 200), (215, 70, 40)) - 255)
    inside = values < 0
    image[1:][inside[1:] != inside[:-1]] = 0
    image[:, 1:][inside[:, 1:] != inside[:, :-1]] = 0
    return image


def bars(counts: np.ndarray, width: int = 480, height: int = 240) -> np.ndarray:
    """A histogram as an image."""
    image = np.full((height, width, 3), 252.0)
    for i, (count, left) in enumerate(zip(counts, np.arange(len(counts)) * width // len(counts))):
        top = height - int(round(count / max(counts.max(), 1) * (height - 8)))
        image[top:, left + 1 : (i + 1) * width // len(counts) - 1] = COLOURS[1]
    return image
