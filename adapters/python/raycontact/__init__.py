# SPDX-License-Identifier: Apache-2.0
"""Collision detection between moving, concave triangle meshes, by casting rays.

    import raycontact as rc
    part = rc.Shape("part.stl")
    print(rc.collide(part, part, pose_b=pose))

`Mesh` and `Shape` hold meshes; `collide`, `intersects`, `distance`, `closest_point`, `signed_distance`, `raycast`,
`contains`, `time_of_impact` and `path_clearance` answer questions about one pair or many at once; a `Scene` steps
bodies in time. Metres, poses as 4 x 4 matrices, normals from a to b, depth > 0 where meshes penetrate. Bad input raises
InputError, a ValueError.
"""

from . import _core
from ._core import DeviceInfo, InputError, MeshReport, StepStats, list_devices
from .clash import Clash, Clashes, ClashGroup, PathClash, PathClashes, clash, clash_along
from .collision import CollisionManager
from .contacts import CONTACT_DTYPE, Contacts, FeatureKind, PairContacts
from .grasps import wrench_cone
from .impacts import BodyImpact, Impact, PathClearance, path_clearance, time_of_impact
from .mesh import AssemblyPart, Mesh, load_assembly
from .poses import nearest_rigid, pose, pose_from_quaternion, slide, turn
from .queries import (
    ClosestPoint,
    ContactPatches,
    Distance,
    OneClosestPoint,
    OneDistance,
    OneRayHit,
    OneSignedDistance,
    RayHit,
    Separation,
    SignedDistance,
    closest_point,
    collide,
    common_point,
    contact_patches,
    contains,
    distance,
    distance_grid,
    intersects,
    raycast,
    raycast_any,
    separation,
    signed_distance,
)  # fmt: skip
from .recording import RecordedStep, Recorder, Recording
from .samples import box, heightfield, samples
from .scene import (
    BodyClosestPoints,
    BodyOverlaps,
    BodyRayHits,
    LostContacts,
    OneBodyClosestPoint,
    OneBodyRayHit,
    Scene,
    SceneState,
    Touches,
)  # fmt: skip
from .shape import Mass, Round, Shape, SheetWarning, ball, capsule, plane
from .show import show

__version__: str = _core.version

__all__ = [
    "AssemblyPart", "BodyClosestPoints", "BodyImpact", "BodyOverlaps", "BodyRayHits", "CONTACT_DTYPE", "Clash",
    "ClashGroup", "Clashes", "ClosestPoint", "CollisionManager", "ContactPatches", "Contacts", "DeviceInfo", "Distance",
    "FeatureKind", "Impact", "InputError", "LostContacts", "Mass", "Mesh", "MeshReport", "OneBodyClosestPoint",
    "OneBodyRayHit", "OneClosestPoint", "OneDistance", "OneRayHit", "OneSignedDistance", "PairContacts", "PathClash",
    "PathClashes", "PathClearance", "RayHit", "RecordedStep", "Recorder", "Recording", "Round", "Scene", "SceneState",
    "Separation", "Shape", "SheetWarning", "SignedDistance", "StepStats", "Touches", "ball", "box", "capsule", "clash",
    "clash_along", "closest_point", "collide", "common_point", "contact_patches", "contains", "distance",
    "distance_grid", "heightfield", "intersects", "list_devices", "load_assembly", "nearest_rigid", "path_clearance",
    "plane", "pose", "pose_from_quaternion", "raycast", "raycast_any", "samples", "separation", "show",
    "signed_distance", "slide", "time_of_impact", "turn", "wrench_cone",
]  # fmt: skip
