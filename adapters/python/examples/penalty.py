# SPDX-License-Identifier: Apache-2.0
"""A tiny solver by penalty forces: springs along normals and along surfaces, from contacts and NumPy alone."""

from __future__ import annotations

import numpy as np
import raycontact as rc

GRAVITY, FRICTION, DENSITY, SAG = 9.81, 0.5, 1000.0, 3e-4  # m/s^2, -, kg/m^3, metres by which a body at rest sinks in
STEP = 1 / 960  # seconds


class World:
    """Bodies about their centres of mass; the first one never moves."""

    def __init__(self, shapes: list[rc.Shape], places: np.ndarray, quaternions: np.ndarray) -> None:
        self.scene = rc.Scene(max_contacts_per_pair=4, threads=1)  # few springs carry each body
        self.ids = self.scene.add(shapes, rc.pose_from_quaternion(places, quaternions))
        self.mass = np.array([DENSITY * shape.mass.volume for shape in shapes])
        self.inverse_mass = 1 / self.mass
        self.inverse_inertia = np.linalg.inv([DENSITY * shape.mass.inertia for shape in shapes])
        self.inverse_mass[0], self.inverse_inertia[0] = 0, 0
        self.speed, self.spin = np.zeros((2, len(shapes), 3))  # m/s, rad/s, world frame
        self.names, self.stretch = np.empty(0, np.uint64), np.empty((0, 3))  # of each contact: metres along the surface
        self.carried = np.zeros(3)

    def step(self) -> None:
        """Semi-implicit Euler: forces of the contacts there are, then speeds, poses and contacts."""
        poses = self.scene.poses()
        centre, turn = poses[:, :3, 3], poses[:, :3, :3]
        contacts = self.scene.contacts
        a, b = contacts.slots.T.astype(int)
        normal, point = contacts.normal, (contacts.point_a + contacts.point_b) / 2
        arm_a, arm_b = point - centre[a], point - centre[b]
        slip = self.speed[b] + np.cross(self.spin[b], arm_b) - self.speed[a] - np.cross(self.spin[a], arm_a)
        apart = np.sum(slip * normal, axis=1)  # m/s, > 0 where they part

        # The lighter body sets stiffness and damping: a quarter of its weight sinks in by SAG.
        light = 1 / np.maximum(self.inverse_mass[a], self.inverse_mass[b])
        stiff, damp = light * GRAVITY / (4 * SAG), 0.5 * light * np.sqrt(GRAVITY / SAG)
        push = np.maximum(stiff * contacts.depth - damp * apart, 0)
        # Friction is a spring along the surface while a contact lasts, which its key tells, and does not slide.
        names = contacts.key ^ (a * len(centre) + b).astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        kept, before, now = np.intersect1d(self.names, names, return_indices=True)
        stretch = STEP * (slip - apart[:, None] * normal)
        stretch[now] += self.stretch[before]
        stretch -= np.sum(stretch * normal, axis=1)[:, None] * normal
        drag = stiff[:, None] * stretch + damp[:, None] * (slip - apart[:, None] * normal)
        slides = np.minimum(FRICTION * push / np.maximum(np.linalg.norm(drag, axis=1), 1e-12), 1)[:, None]
        self.names, self.stretch = names, stretch * slides
        force = push[:, None] * normal - slides * drag  # on b, N

        total, torque = np.zeros((2, len(centre), 3))
        for body, arm, sign in ((a, arm_a, -1), (b, arm_b, 1)):
            np.add.at(total, body, sign * force)
            np.add.at(torque, body, sign * np.cross(arm, force))
        self.carried = total[0]
        self.speed += STEP * (total * self.inverse_mass[:, None] - (self.inverse_mass > 0)[:, None] * (0, 0, GRAVITY))
        self.spin += STEP * np.einsum("nij,njk,nlk,nl->ni", turn, self.inverse_inertia, turn, torque)
        angle = STEP * np.linalg.norm(self.spin, axis=1, keepdims=True)
        half = np.c_[np.cos(angle / 2), np.sinc(angle / 2 / np.pi) * STEP / 2 * self.spin]
        poses[:, :3, :3] = rc.pose_from_quaternion(np.zeros(3), half)[:, :3, :3] @ turn
        poses[:, :3, 3] += STEP * self.speed
        self.scene.set_poses(self.ids, rc.nearest_rigid(poses))
        self.scene.find_contacts()
