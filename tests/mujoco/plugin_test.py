# SPDX-License-Identifier: Apache-2.0
"""MuJoCo with meshes as drawn: what collides, in which fields, on which threads."""

import gc
import subprocess
import sys

import mujoco
import numpy as np
import pytest
import raycontact as rc
import raycontact.mujoco as rm
from models import asset, box, linked_tori, model, steps, torus, touching
from mujoco import rollout


@pytest.fixture(autouse=True)
def installed():
    yield
    rm.install()


def contacts(data):
    return [(c.dist, tuple(c.pos), tuple(c.frame)) for c in data.contact]


def test_a_torus_hangs_in_another():
    data, deepest = steps(linked_tori(), 4)
    assert data.qpos[2] == pytest.approx(-0.16, abs=0.003)
    assert data.qvel[:3] == pytest.approx(0, abs=0.05)
    assert deepest > -0.006


def test_without_the_plugin_it_is_a_hull_again():
    rm.uninstall()
    data, _ = steps(linked_tori(), 1)
    assert abs(data.qpos[2]) > 1  # thrown out of the other's hull


def test_sdf_geoms_have_as_many_contacts_as_their_slots():
    made = model(
        asset("block", box((0.2, 0.2, 0.1))),
        '<geom type="sdf" mesh="block"/><body pos="0 0 0.199" euler="0 0 20"><freejoint/>'
        '<geom type="sdf" mesh="block"/></body>',
        options='timestep="0.002" sdf_initpoints="6"',
    )
    data = mujoco.MjData(made)
    mujoco.mj_forward(made, data)
    assert mujoco.mj_maxContact(made, 0, 1, -1) == 6
    assert 4 <= data.ncon <= 6


@pytest.mark.parametrize("step", [0.001, 0.002])
@pytest.mark.parametrize("friction", [0.5, 0.01])
def test_a_nut_holds_by_friction_and_turns_down_without(friction, step):
    """A thread of 1.5 mm a turn, steep by 1 in 28, and some hundredths of a millimetre of play. With 0.02 it
    hardly slides: pyramids of friction are coarse."""
    samples = rc.samples()
    nut_and_bolt = "".join(asset(name, (samples[name].vertices, samples[name].triangles)) for name in ("bolt", "nut"))
    like = f'type="sdf" friction="{friction}"'
    made = model(
        nut_and_bolt,
        f'<geom mesh="bolt" {like}/><body pos="0 0 0.012"><freejoint/><geom mesh="nut" {like}/></body>',
        f'timestep="{step}" integrator="implicitfast"',
    )
    data, heights, turns = mujoco.MjData(made), [], []
    for _ in range(round(0.5 / step)):
        mujoco.mj_step(made, data)
        heights.append(data.qpos[2])
        turns.append(2 * np.arctan2(data.qpos[6], data.qpos[3]))
        assert data.ncon <= 40
    heights, turns = np.array(heights), np.unwrap(turns)
    late = slice(len(heights) // 2, None)
    assert np.abs(data.qpos[:2]).max() < 1e-4
    if friction > 0.1:
        assert np.ptp(heights[late]) < 5e-6 and np.ptp(turns[late]) < 0.01
    else:
        turned = turns[late][-1] - turns[late][0]
        assert turned < -0.5
        assert heights[late][-1] - heights[late][0] == pytest.approx(0.0015 * turned / (2 * np.pi), abs=3e-5)


# A fifth contact of two meshes would be written beyond what MuJoCo has room for.
def test_no_more_contacts_than_slots():
    fine = torus(around=64, across=32)
    made = model(
        asset("torus", fine),
        '<geom type="mesh" mesh="torus"/>'
        + "".join(
            f'<body pos="0 0 {0.038 * (i + 1)}" euler="0 0 {7 * i}"><freejoint/><geom type="mesh" mesh="torus"/></body>'
            for i in range(6)
        ),
    )
    before = rm.counts()
    data, _ = steps(made, 0.5)
    after = rm.counts()
    assert after.left_out > before.left_out
    pairs = [tuple(sorted(g)) for g in data.contact.geom]
    assert all(pairs.count(p) <= mujoco.mj_maxContact(made, *p, -1) for p in set(pairs))


# The next model may lie where the last one was, as large, with other vertices: found by what the mesh is.
def test_models_that_come_and_go_have_their_own_shapes():
    addresses = set()
    for i in range(30):
        half = 0.1 + 0.01 * (i % 3)
        made = model(
            asset("one", box((0.2, 0.2, half))) + asset("two", box((0.1, 0.1, 0.1))),
            '<geom type="mesh" mesh="one"/><body pos="0 0 0.21"><freejoint/><geom type="mesh" mesh="two"/></body>',
        )
        data = mujoco.MjData(made)
        mujoco.mj_forward(made, data)
        addresses.add(made._address)
        if half < 0.11:
            assert data.ncon == 0
        else:
            assert data.contact.dist.min() == pytest.approx(0.11 - half, abs=1e-6)
        del made, data
        gc.collect()
    assert len(addresses) < 30


def test_a_mesh_that_is_changed_in_place_is_seen():
    made, data = touching('type="mesh" mesh="block"', 'type="mesh" mesh="block"', "0 0 0.199")
    assert data.contact.dist.min() == pytest.approx(-0.001, abs=1e-6)
    made.mesh_vert *= 1.1
    mujoco.mj_forward(made, data)
    assert data.contact.dist.min() == pytest.approx(-0.021, abs=1e-6)


def crowd():
    rng = np.random.default_rng(66)
    bodies = "".join(
        f'<body pos="{x:.3f} {y:.3f} {0.1 + 0.06 * k:.3f}" euler="{a:.0f} {b:.0f} 0"><freejoint/>'
        f'<geom type="mesh" mesh="torus"/></body>'
        for k, (x, y, a, b) in enumerate(rng.uniform([-0.1, -0.1, 0, 0], [0.1, 0.1, 360, 360], (12, 4)))
    )
    return model(asset("torus", torus()), '<geom type="plane" size="2 2 0.1"/>' + bodies)


def test_bits_are_equal_for_any_number_of_threads():
    made = crowd()
    states = []
    for threads in (0, 1, 2, 4):
        data = mujoco.MjData(made)
        if threads:
            mujoco.mju_threadpool(data, threads)
        for _ in range(400):
            mujoco.mj_step(made, data)
        states.append((data.qpos.tobytes(), data.qvel.tobytes(), data.ncon))
    assert len(set(states)) == 1
    assert states[0][2] > 10


def test_rollouts_on_threads_are_those_of_one():
    made = crowd()
    state = np.zeros(mujoco.mj_stateSize(made, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    data = mujoco.MjData(made)
    mujoco.mj_getState(made, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.tile(state, (6, 1))
    start[:, -1] += np.arange(6) * 0.1
    one, _ = rollout.rollout(made, data, start, nstep=150)
    many, _ = rollout.rollout(made, [mujoco.MjData(made) for _ in range(3)], start, nstep=150)
    assert one.tobytes() == many.tobytes()


def test_a_step_depends_on_no_step_before():
    made = linked_tori()
    data, _ = steps(made, 0.3)
    found = contacts(data)
    other = mujoco.MjData(made)
    other.qpos[:], other.qvel[:] = data.qpos, data.qvel
    mujoco.mj_forward(made, data)
    mujoco.mj_forward(made, other)
    assert contacts(other) == contacts(data)
    assert found


def test_margin_and_gap_count_what_is_apart():
    for margin, gap, expected in ((0, 0, False), (0.02, 0, True), (0.004, 0, False), (0.02, 0.015, True)):
        _, data = touching(
            'type="mesh" mesh="block"', f'type="mesh" mesh="block" margin="{margin}" gap="{gap}"', "0 0 0.21"
        )
        assert bool(data.ncon) == expected, margin
        if expected:
            assert data.contact.dist.min() == pytest.approx(0.01, abs=1e-6)
            assert 4 <= data.ncon <= 5


# What MuJoCo makes of a pair's geoms is in the contact as it is without us.
@pytest.mark.parametrize(
    "extra",
    [
        'friction="0.3 0.02 0.001" solref="0.03 0.9" solimp="0.8 0.9 0.01 0.4 3" condim="6"',
        'priority="2" friction="0.1 0.01 0.001" condim="1"',
        'solmix="3" solref="0.05 1"',
        'margin="0.01" gap="0.002"',
    ],
)
def test_fields_are_those_of_mujoco(extra):
    for options in ("", 'timestep="0.002"><flag override="enable"/></option><option o_margin="0.01"'):
        fields = []
        for ours in (True, False):
            rm.install() if ours else rm.uninstall()
            _, data = touching('type="mesh" mesh="block"', f'type="mesh" mesh="block" {extra}', "0 0 0.198", options)
            c = data.contact[0]
            fields.append([*c.friction, *c.solref, *c.solreffriction, *c.solimp, c.includemargin, c.dim, *c.geom])
            assert c.frame[:3] == pytest.approx([0, 0, 1], abs=1e-6)
            assert (
                np.linalg.norm(np.array(c.frame).reshape(3, 3) @ np.array(c.frame).reshape(3, 3).T - np.eye(3)) < 1e-9
            )
            assert c.dist == pytest.approx(-0.002, abs=1e-6)
        assert fields[0] == fields[1]


def test_pairs_of_the_model_keep_their_fields():
    _, data = touching(
        'type="mesh" mesh="block"',
        'type="mesh" mesh="block" contype="0" conaffinity="0"',
        "0 0 0.198",
        more='<contact><pair geom1="a" geom2="b" condim="4" friction="0.7 0.6 0.01 0.001 0.002"/></contact>',
    )
    assert data.ncon >= 4
    assert data.contact[0].dim == 4
    assert data.contact[0].friction == pytest.approx([0.7, 0.6, 0.01, 0.001, 0.002])


# On a convex mesh MuJoCo's own functions find the same.
@pytest.mark.parametrize(
    ("shape", "height", "euler"),
    [
        ('type="sphere" size="0.05"', 0.148, "0 0 0"),
        ('type="capsule" size="0.03 0.08"', 0.128, "90 0 0"),
        ('type="capsule" size="0.03 0.08"', 0.205, "20 0 0"),
        ('type="ellipsoid" size="0.05 0.06 0.03"', 0.128, "0 0 0"),
        ('type="cylinder" size="0.05 0.03"', 0.128, "0 0 0"),
        ('type="cylinder" size="0.05 0.03"', 0.148, "90 0 0"),
        ('type="box" size="0.05 0.06 0.03"', 0.128, "0 0 0"),
    ],
)
def test_other_geoms_on_a_block_lie_as_in_mujoco(shape, height, euler):
    deepest = []
    for ours in (True, False):
        rm.install() if ours else rm.uninstall()
        before = rm.counts().calls
        _, data = touching('type="mesh" mesh="block"', shape, f"0.02 0.03 {height}", euler=euler)
        assert (rm.counts().calls > before) == ours
        assert data.ncon > 0
        c = min(data.contact, key=lambda c: c.dist)
        sign = 1 if c.geom[0] == 0 else -1
        assert sign * c.frame[2] == pytest.approx(1, abs=1e-3)
        assert abs(c.pos[2] - 0.1) < 0.006
        deepest.append(c.dist)
    assert deepest[0] == pytest.approx(deepest[1], abs=1e-4)


# Through the hole of a torus what is thinner passes; its hull would hold it.
@pytest.mark.parametrize(
    "shape",
    ['type="sphere" size="0.06"', 'type="capsule" size="0.04 0.05"', 'type="box" size="0.04 0.04 0.05"',
     'type="cylinder" size="0.05 0.05"', 'type="ellipsoid" size="0.05 0.06 0.07"'],
)  # fmt: skip
def test_other_geoms_fall_through_a_hole(shape):
    made = model(
        asset("torus", torus()),
        f'<geom type="mesh" mesh="torus"/><body pos="0 0 0.2"><freejoint/><geom {shape}/></body>',
    )
    data, deepest = steps(made, 0.5)
    assert data.qpos[2] < -0.3
    assert deepest == 0


def test_a_capsule_lies_on_both_ends():
    made, data = touching('type="mesh" mesh="block"', 'type="capsule" size="0.03 0.08"', "0 0 0.129", euler="90 0 0")
    assert data.ncon >= 2
    ends = sorted(c.pos[1] for c in data.contact)
    assert ends[0] == pytest.approx(-0.08, abs=1e-3)
    assert ends[-1] == pytest.approx(0.08, abs=1e-3)
    assert all(c.dist == pytest.approx(-0.001, abs=1e-6) for c in data.contact)
    assert made.ngeom == 2


def test_a_mesh_rests_on_a_height_field():
    heights = " ".join(str(h) for h in [0.0, 0.2, 0.4, 0.2, 0.4, 0.6, 0.4, 0.6, 0.8])
    made = model(
        asset("torus", torus()) + f'<hfield name="slope" nrow="3" ncol="3" size="1 1 0.2 0.1" elevation="{heights}"/>',
        '<geom type="hfield" hfield="slope" friction="2"/>'
        '<body pos="0 0 0.2"><freejoint/><geom type="mesh" mesh="torus" friction="2"/></body>',
    )
    data, deepest = steps(made, 1.5)
    assert data.ncon >= 3
    assert deepest > -0.01
    assert 0 < data.qpos[2] < 0.2


# The cells' triangles are MuJoCo's: a small ball beside either diagonal has the same depth.
def test_the_triangles_of_a_height_field_are_those_of_mujoco():
    for elevation in ("0 1 0 0", "0 0 1 0", "1 0 0 0", "0 0 0 1", "0 1 1 0", "1 0 0 1"):
        for x, y in ((0.1, 0.1), (-0.1, 0.2), (0.3, -0.2), (-0.3, -0.3)):
            found = []
            for shape in ('type="mesh" mesh="ball"', 'type="sphere" size="0.01"'):
                made = model(
                    f'<mesh name="ball" inertia="exact" builtin="sphere" params="4" scale="0.01 0.01 0.01"/>'
                    f'<hfield name="cell" nrow="2" ncol="2" size="1 1 0.5 0.1" elevation="{elevation}"/>',
                    f'<geom type="hfield" hfield="cell"/><body pos="{x} {y} 0"><freejoint/><geom {shape}/></body>',
                )
                data = mujoco.MjData(made)
                low, high = -0.02, 1.0  # where it begins to touch
                for _ in range(40):
                    middle = 0.5 * (low + high)
                    data.qpos[2] = middle
                    mujoco.mj_forward(made, data)
                    low, high = (middle, high) if data.ncon else (low, middle)
                found.append(low)
            assert found[0] == pytest.approx(found[1], abs=5e-4), (elevation, x, y)


def test_models_and_geoms_can_stay_as_they_are():
    calls = rm.counts().calls
    steps(linked_tori(more='<custom><numeric name="raycontact" data="0"/></custom>'), 0.01)
    assert rm.counts().calls == calls
    out = '<custom><tuple name="raycontact"><element objtype="geom" objname="hung" prm="0"/></tuple></custom>'
    steps(linked_tori(more=out), 0.01)
    assert rm.counts().calls == calls
    other = '<custom><tuple name="raycontact"><element objtype="geom" objname="hung" prm="1"/></tuple></custom>'
    steps(linked_tori(more=other), 0.01)
    assert rm.counts().calls == calls
    both = (
        '<custom><tuple name="raycontact"><element objtype="geom" objname="hung" prm="1"/>'
        '<element objtype="geom" objname="fixed" prm="1"/></tuple></custom>'
    )
    steps(linked_tori(more=both), 0.01)
    assert rm.counts().calls > calls


def test_distances_are_of_meshes_as_drawn():
    made = model(
        asset("torus", torus()),
        '<geom name="a" type="mesh" mesh="torus" euler="90 0 0"/><body pos="0 0 -0.1" euler="90 90 0"><freejoint/>'
        '<geom name="b" type="mesh" mesh="torus"/></body>',
        more='<sensor><distance geom1="a" geom2="b" cutoff="1"/></sensor>',
    )
    data = mujoco.MjData(made)  # the tube of each in the middle of the other's hole
    mujoco.mj_forward(made, data)
    fromto = np.zeros(6)
    found = mujoco.mj_geomDistance(made, data, 0, 1, 1.0, fromto)
    assert found == pytest.approx(0.06, abs=0.002)
    assert data.sensordata[0] == found
    shapes = [rc.Shape(rc.Mesh(*torus())) for _ in range(2)]
    near = rc.distance(*shapes, *poses_of(made, data))
    assert found == pytest.approx(float(near.distance), abs=1e-6)
    for point, shape, pose in ((fromto[:3], shapes[0], 0), (fromto[3:], shapes[1], 1)):
        assert rc.closest_point(shape, point, poses_of(made, data)[pose]).distance < 1e-6
    assert mujoco.mj_geomDistance(made, data, 0, 1, 0.01, fromto) == 0.01
    assert (fromto == 0).all()
    rm.uninstall()
    assert mujoco.mj_geomDistance(made, data, 0, 1, 1.0, None) < 0  # of hulls


def poses_of(made, data):
    poses = np.tile(np.eye(4), (2, 1, 1))
    for g in (0, 1):
        mesh = made.geom_dataid[g]
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, made.mesh_quat[mesh])
        poses[g, :3, :3] = data.geom_xmat[g].reshape(3, 3) @ turn.reshape(3, 3).T
        poses[g, :3, 3] = data.geom_xpos[g] - poses[g, :3, :3] @ made.mesh_pos[mesh]
    return poses


def test_another_version_is_refused_by_name(monkeypatch):
    assert mujoco.__version__ in rm.versions()
    monkeypatch.setattr(mujoco, "__version__", "3.9.0")
    with pytest.raises(ImportError, match=r"no plugin for mujoco 3\.9\.0, but for .*4\.0\.0"):
        rm.library()


def test_a_program_can_load_the_library_itself():
    script = (
        f"import mujoco; mujoco.mj_loadPluginLibrary({rm.library()!r}); from models import linked_tori, steps; "
        "print(steps(linked_tori(), 1)[0].qpos[2])"
    )
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert float(out.stdout) == pytest.approx(-0.16, abs=0.01)


def test_a_centre_of_mass_that_is_not_the_meshs_own_is_told_once(tmp_path):
    script = (
        "import raycontact.mujoco, mujoco, numpy as np; from models import model, asset, torus\n"
        "v, f = torus(); v = np.concatenate([v, v * 0.3 + [0.2, 0, 0]]); f = np.concatenate([f, f + len(v) // 2])\n"
        "for inertia in ('exact', 'legacy', 'legacy'):\n"
        "    m = model(asset('odd', (v, f)).replace('exact', inertia) + asset('torus', torus()),\n"
        '        \'<geom type="mesh" mesh="torus"/><body pos="0 0 0.03"><freejoint/>\'\n'
        '        \'<geom type="mesh" mesh="odd"/></body>\')\n'
        "    mujoco.mj_forward(m, mujoco.MjData(m)); print(inertia, flush=True)\n"
    )
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=tmp_path)
    log = tmp_path / "MUJOCO_LOG.TXT"
    told = out.stdout + out.stderr + (log.read_text() if log.exists() else "")
    assert told.count('inertia="exact"') in (1, 2)  # on the terminal, in the log, or both
