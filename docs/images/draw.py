#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the drawings of docs/concepts.md beside itself: python3 docs/images/draw.py"""
from math import cos, hypot, radians, sin
from pathlib import Path

BLUE, ORANGE, GREEN, PURPLE, GREY = "#2f6fb3", "#c4561a", "#1b7f3b", "#7a1fa2", "#888"
PALE_BLUE, PALE_ORANGE = "#dbe8f6", "#fbe2d2"


class Drawing:
    def __init__(self, name, width, height, title):
        self.name, self.parts = name, [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}"'
            f' font-family="sans-serif" font-size="14" fill="none" stroke-linejoin="round"><title>{title}</title>',
            f'<rect width="{width}" height="{height}" fill="#fff"/>']

    def add(self, text):
        self.parts.append(text)

    def shape(self, points, fill, stroke, width=1.6, opacity=1):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.add(f'<polygon points="{path}" fill="{fill}" fill-opacity="{opacity}" stroke="{stroke}" stroke-width="{width}"/>')

    def line(self, *points, stroke="#222", width=1.6, dash=""):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(f'<polyline points="{path}" stroke="{stroke}" stroke-width="{width}"{dashes}/>')

    def arrow(self, a, b, stroke="#222", width=2.2, dash=""):
        self.line(a, b, stroke=stroke, width=width, dash=dash)
        length = hypot(b[0] - a[0], b[1] - a[1])
        x, y = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        self.line((b[0] - 10 * x + 5 * y, b[1] - 10 * y - 5 * x), b, (b[0] - 10 * x - 5 * y, b[1] - 10 * y + 5 * x),
                  stroke=stroke, width=width)

    def dot(self, at, fill, radius=4.5):
        self.add(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius}" fill="{fill}"/>')

    def circle(self, at, radius, fill, stroke, dash="", width=1.6):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"{dashes}/>')

    def text(self, x, y, words, fill="#222", anchor="start", size=14, weight="normal"):
        for i, line in enumerate(words.split("\n")):
            line = line.replace("&", "&amp;").replace("<", "&lt;")
            self.add(f'<text x="{x:.1f}" y="{y + i * size * 1.25:.1f}" fill="{fill}" text-anchor="{anchor}"'
                     f' font-size="{size}" font-weight="{weight}">{line}</text>')

    def save(self):
        Path(__file__).with_name(self.name).write_text("\n".join(self.parts + ["</svg>"]) + "\n")


def ray():
    d = Drawing("concept-ray.svg", 660, 330, "The ray of a vertex")
    d.shape([(20, 275), (640, 85), (640, 310), (20, 310)], PALE_BLUE, BLUE)
    v = (300, 272)
    d.shape([v, (392, 160), (400, 45), (215, 35), (205, 150)], PALE_ORANGE, ORANGE, opacity=0.75)
    top = (300, 275 - 190 / 620 * 280)
    d.line(top, (300, 40), stroke=PURPLE, width=1.6, dash="5 4")
    d.arrow(v, top, stroke=PURPLE, width=2.6)
    n = (-190 / 648.5, -620 / 648.5)
    depth = (v[1] - top[1]) * -n[1]
    foot = (v[0] + depth * n[0], v[1] + depth * n[1])
    d.arrow(v, foot, stroke=GREEN, width=2.6)
    d.dot(v, "#222")
    d.dot(top, PURPLE)
    d.text(312, 292, "v: a vertex of A, inside B")
    d.text(411, 96, "A, the source", ORANGE, weight="bold")
    d.text(530, 250, "B, the target", BLUE, weight="bold")
    d.text(309, 240, "r: the ray, along the inward\nnormal of v, to B's surface", PURPLE)
    d.text(300, 24, "t_max: where the ray leaves A", PURPLE, anchor="middle", size=13)
    d.text(24, 142, "normal of the face\nthat was hit", GREEN)
    d.line((146, 168), ((v[0] + foot[0]) / 2 - 3, (v[1] + foot[1]) / 2), stroke=GREEN, width=1)
    d.text(24, 192, "depth = r · normal", GREEN)
    d.save()


def pipeline():
    d = Drawing("concept-pipeline.svg", 760, 235, "From poses to contacts")

    def box(x, y, words, fill="#f4f4f4", stroke=GREY, width=120):
        d.add(f'<rect x="{x}" y="{y}" width="{width}" height="54" rx="6" fill="{fill}" stroke="{stroke}" stroke-width="1.6"/>')
        lines = words.split("\n")
        d.text(x + width / 2, y + (32 if len(lines) == 1 else 23), words, anchor="middle")

    d.text(20, 24, "once for each mesh", GREY)
    box(20, 34, "mesh")
    box(190, 34, "shape", PALE_BLUE, BLUE)
    d.arrow((142, 61), (186, 61))
    d.text(325, 50, "welded, checked, normals, exit distances,\nbounding volume hierarchy", size=13, fill="#444")
    d.text(20, 130, "each step", GREY)
    names = [("poses", "#f4f4f4", GREY), ("broad phase:\npairs", PALE_BLUE, BLUE), ("rays and\nedges due", PALE_BLUE, BLUE),
             ("hits", PALE_BLUE, BLUE), ("contacts", PALE_BLUE, BLUE), ("your solver", "#f4f4f4", GREY)]
    for i, (name, fill, stroke) in enumerate(names):
        box(20 + i * 124, 140, name, fill, stroke, 100)
        if i:
            d.arrow((20 + i * 124 - 22, 167), (20 + i * 124 - 3, 167))
    d.line((250, 88), (250, 112), (318, 112), (318, 138), stroke=BLUE, dash="4 3")
    d.text(144, 216, "RayContact (blue)", BLUE, size=13)
    d.line((690, 196), (690, 222), (70, 222), (70, 200), stroke=GREY, dash="4 3")
    d.line((65, 209), (70, 199), (75, 209), stroke=GREY)
    d.save()


def edges():
    d = Drawing("concept-edges.svg", 660, 330, "Edges that cross while no vertex is inside")

    def at(x, y, z, ox=190, oy=190, s=62):
        return ox + s * cos(radians(30)) * (x - y), oy + s * (0.5 * (x + y) - z)

    def prism_x(z, base, half, length, fill, stroke, opacity):
        a, b = -length, length
        d.shape([at(a, -half, base), at(b, -half, base), at(b, 0, z), at(a, 0, z)], fill, stroke, opacity=opacity)
        d.shape([at(a, half, base), at(b, half, base), at(b, 0, z), at(a, 0, z)], fill, stroke, opacity=opacity)
        d.shape([at(b, -half, base), at(b, half, base), at(b, 0, z)], fill, stroke, opacity=opacity)

    def prism_y(z, base, half, length, fill, stroke, opacity):
        a, b = -length, length
        d.shape([at(-half, a, base), at(-half, b, base), at(half, b, base), at(half, a, base)], fill, stroke, opacity=opacity)
        d.shape([at(half, a, base), at(half, b, base), at(0, b, z), at(0, a, z)], fill, stroke, opacity=opacity)
        d.shape([at(half, b, base), at(-half, b, base), at(0, b, z)], fill, stroke, opacity=opacity)

    prism_x(0.0, -0.9, 0.7, 1.9, PALE_BLUE, BLUE, 0.9)
    prism_y(-0.35, 0.75, 0.7, 1.9, PALE_ORANGE, ORANGE, 0.62)
    d.line(at(-1.9, 0, 0), at(1.9, 0, 0), stroke=BLUE, width=3.2)
    d.line(at(0, -1.9, -0.35), at(0, 1.9, -0.35), stroke=ORANGE, width=3.2)
    d.arrow(at(0, 0, -0.35), at(0, 0, 0.0), stroke=GREEN, width=3)
    d.dot(at(0, 0, -0.35), "#222", 4)
    d.dot(at(0, 0, 0), "#222", 4)
    d.text(352, 58, "an edge of A", ORANGE, weight="bold")
    d.text(352, 76, "passes through", "#222")
    d.text(352, 94, "an edge of B", BLUE, weight="bold")
    d.text(352, 130, "No vertex of either is inside the\nother: rays of vertices see nothing.")
    d.text(352, 186, "features = edges finds the contact:", "#222")
    d.text(352, 206, "normal: across both edges", GREEN)
    d.text(352, 226, "depth: how far they passed", GREEN)
    d.text(352, 262, "features = vertices, the paper's\nrule, reports no contact here.")
    d.save()


def speculative():
    d = Drawing("concept-speculative.svg", 700, 290, "Speculative contacts")
    for x in (20, 365):
        d.shape([(x, 200), (x + 315, 200), (x + 315, 270), (x, 270)], PALE_BLUE, BLUE)
        d.text(x + 10, 258, "B", BLUE, weight="bold")
    d.line((20, 150), (335, 150), stroke=GREEN, dash="5 4")
    d.text(26, 144, "margin", GREEN, size=13)
    v = (150, 172)
    d.shape([v, (215, 115), (190, 60), (110, 60), (90, 115)], PALE_ORANGE, ORANGE, opacity=0.8)
    d.text(143, 92, "A", ORANGE, weight="bold")
    d.arrow(v, (150, 199), stroke=PURPLE)
    d.dot(v, "#222")
    d.text(160, 192, "gap", PURPLE)
    d.text(20, 26, "Slow: nearer than the margin", weight="bold")
    d.text(232, 92, "a contact with\ndepth = −gap", "#222", size=13)
    d.text(365, 26, "Fast: meets a face before the next step", weight="bold")
    w, ahead = (430, 88), (560, 246)
    d.shape([w, (466, 66), (458, 42), (410, 42), (402, 66)], PALE_ORANGE, ORANGE, opacity=0.8)
    d.shape([ahead, (596, 224), (588, 200), (540, 200), (532, 224)], "none", ORANGE, width=1.2)
    meets = (430 + 130 * 112 / 158, 200)
    d.arrow(w, ahead, stroke=ORANGE, width=1.8, dash="6 4")
    d.arrow(w, (430, 199), stroke=PURPLE)
    d.dot(w, "#222")
    d.dot(meets, ORANGE)
    d.text(382, 155, "gap", PURPLE)
    d.text(514, 132, "its way to the next step", ORANGE, size=13)
    d.text(482, 66, "now", size=13)
    d.text(602, 246, "next step", size=13)
    d.save()


def concave():
    d = Drawing("concept-concave.svg", 720, 290, "Why concave meshes need this")
    cup = [(0, 40), (18, 40), (40, 150), (120, 150), (142, 40), (160, 40), (135, 175), (25, 175)]

    def cup_at(x, y, fill=PALE_BLUE):
        d.shape([(x + a, y + b) for a, b in cup], fill, BLUE)

    d.text(30, 26, "Its triangles", weight="bold")
    cup_at(30, 60)
    d.circle((110, 176), 34, PALE_ORANGE, ORANGE)
    d.text(30, 262, "The ball lies in the cup.", size=13)
    d.text(265, 26, "Its convex hull", weight="bold")
    hull = [(265, 100), (425, 100), (400, 235), (290, 235)]
    d.shape(hull, "#eef3fa", BLUE, width=1.2)
    cup_at(265, 60)
    d.line(*hull, hull[0], stroke=BLUE, width=2.4, dash="5 4")
    d.circle((345, 66), 34, PALE_ORANGE, ORANGE)
    d.text(265, 262, "The ball lies on a lid\nthat is not there.", size=13)
    d.text(500, 26, "Convex parts", weight="bold")
    cup_at(500, 60, "#fff")
    for part in ([(496, 96), (524, 96), (544, 216), (519, 236)], [(664, 96), (636, 96), (616, 216), (641, 236)],
                 [(522, 238), (638, 238), (620, 198), (540, 198)]):
        d.shape(part, "#eef3fa", BLUE, width=2, opacity=0.8)
    d.circle((580, 163), 34, PALE_ORANGE, ORANGE)
    d.text(500, 262, "The ball lies on parts that are\nnot the mesh, made beforehand.", size=13)
    d.save()


def reuse():
    d = Drawing("concept-certificate.svg", 700, 310, "What certified keeps from step to step")
    d.shape([(20, 120), (60, 60), (120, 70), (150, 130), (110, 190), (45, 180)], PALE_BLUE, BLUE)
    d.text(70, 130, "B", BLUE, weight="bold")
    v = (255, 112)
    d.shape([v, (300, 62), (365, 75), (375, 140), (315, 172), (268, 160)], PALE_ORANGE, ORANGE, opacity=0.85)
    d.text(320, 122, "A", ORANGE, weight="bold")
    d.circle(v, 108, "none", GREEN, dash="5 4")
    d.arrow(v, (148, 124), stroke=GREEN)
    d.dot(v, "#222")
    d.text(196, 106, "e", GREEN, weight="bold")
    d.text(405, 56, "A vertex outside, at distance e,", "#222")
    d.text(405, 75, "cannot be in contact before the")
    d.text(405, 94, "pair has moved by e.")
    d.text(405, 130, "So its certificate is valid until the", GREEN)
    d.text(405, 149, "pair's displacement reaches e.", GREEN)
    y = 262
    d.arrow((40, y), (670, y), stroke="#222", width=1.4)
    d.text(670, y + 26, "steps", anchor="end", size=13)
    for i, due in enumerate([1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]):
        x = 60 + i * 50
        d.line((x, y - 5), (x, y + 5), width=1.4)
        if due:
            d.dot((x, y), PURPLE, 7)
    d.text(60, y + 26, "tested: e is found", PURPLE, anchor="start", size=13)
    d.text(310, y + 26, "e is used up: tested again", PURPLE, anchor="middle", size=13)
    for a, b in ((68, 302), (318, 452)):
        d.line((a, y - 14), (a, y - 20), (b, y - 20), (b, y - 14), stroke=GREEN)
    d.text(185, y - 27, "skipped: displacement < e", GREEN, anchor="middle", size=13)
    d.text(385, y - 27, "skipped", GREEN, anchor="middle", size=13)
    d.save()


for draw in (ray, pipeline, edges, speculative, concave, reuse):
    draw()
