// SPDX-License-Identifier: Apache-2.0
// What one version of MuJoCo loads: its collision functions for meshes and SDFs are ours from then on. Built for each
// version against its headers, since the layout of mjModel and mjData changes; what it finds is in the library beside.
#include "contacts.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <utility>

namespace {

using raycontact::mujoco::Geom;
using raycontact::mujoco::Point;

constexpr std::array partners{mjGEOM_HFIELD,   mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                              mjGEOM_CYLINDER, mjGEOM_BOX,    mjGEOM_MESH,    mjGEOM_SDF};
std::array<std::array<mjfCollision, mjNGEOMTYPES>, mjNGEOMTYPES> before;
bool installed = false;

/// A custom numeric "raycontact" of 0 opts a model out, a tuple "raycontact" the geoms that it lists with 0; one that
/// lists geoms with 1 alone opts the others out.
bool wants(const mjModel* m, int g1, int g2) {
    if (m->nnumeric > 0) {
        const int of_model = mj_name2id(m, mjOBJ_NUMERIC, "raycontact");
        if (of_model >= 0 && m->numeric_data[m->numeric_adr[of_model]] == 0) return false;
    }
    if (m->ntuple == 0) return true;
    const int tuple = mj_name2id(m, mjOBJ_TUPLE, "raycontact");
    if (tuple < 0) return true;
    const int begin = m->tuple_adr[tuple], end = begin + m->tuple_size[tuple];
    bool any_in = false;
    for (int i = begin; i < end; ++i) any_in = any_in || m->tuple_objprm[i] != 0;
    const auto is_in = [&](int g) {
        for (int i = begin; i < end; ++i)
            if (m->tuple_objtype[i] == mjOBJ_GEOM && m->tuple_objid[i] == g) return m->tuple_objprm[i] != 0;
        return !any_in;
    };
    return is_in(g1) && is_in(g2);
}

/// False where there is nothing to read: an SDF without a mesh.
bool read(const mjModel* m, const mjData* d, int g, Geom& geom) {
    geom.number = g;
    std::copy_n(d->geom_xmat + 9 * g, 9, geom.rotation.begin());
    std::copy_n(d->geom_xpos + 3 * g, 3, geom.translation.begin());
    std::copy_n(m->geom_size + 3 * g, 3, geom.size.begin());
    const int id = m->geom_dataid[g];
    switch (m->geom_type[g]) {
    case mjGEOM_HFIELD:
        geom.kind = Geom::Kind::height_field;
        geom.rows = m->hfield_nrow[id];
        geom.columns = m->hfield_ncol[id];
        std::copy_n(m->hfield_size + 4 * id, 4, geom.size.begin());
        geom.vertices = {m->hfield_data + m->hfield_adr[id], std::size_t(geom.rows) * std::size_t(geom.columns)};
        return true;
    case mjGEOM_SPHERE:
        geom.kind = Geom::Kind::ball;
        return true;
    case mjGEOM_CAPSULE:
        geom.kind = Geom::Kind::capsule;
        return true;
    case mjGEOM_ELLIPSOID:
        geom.kind = Geom::Kind::ellipsoid;
        return true;
    case mjGEOM_CYLINDER:
        geom.kind = Geom::Kind::cylinder;
        return true;
    case mjGEOM_BOX:
        geom.kind = Geom::Kind::box;
        return true;
    default:
        break;
    }
    if (id < 0) return false;
    geom.kind = Geom::Kind::mesh;
    geom.is_field = m->geom_type[g] == mjGEOM_SDF;
    geom.vertices = {m->mesh_vert + 3 * m->mesh_vertadr[id], 3 * std::size_t(m->mesh_vertnum[id])};
    geom.faces = {m->mesh_face + 3 * m->mesh_faceadr[id], 3 * std::size_t(m->mesh_facenum[id])};
    return true;
}

/// A C++ exception must not pass through MuJoCo: its own error ends the step, as for its own faults.
[[noreturn]] void fail(const mjModel* m, int g1, int g2, const std::string& why) {
    static thread_local char text[1000];
    const auto name = [&](int g) {
        const char* const given = mj_id2name(m, mjOBJ_GEOM, g);
        return given != nullptr && *given != 0 ? std::string(given) : std::to_string(g);
    };
    std::snprintf(text, sizeof text, "raycontact: geoms %s and %s: %s", name(g1).c_str(), name(g2).c_str(),
                  why.c_str());
    mju_error("%s", text);
    std::terminate();
}

int collide(const mjModel* m, mjData* d, mjPreContact* contacts, int g1, int g2, mjtNum margin) {
    const mjfCollision others = before[std::size_t(m->geom_type[g1])][std::size_t(m->geom_type[g2])];
    if (!wants(m, g1, g2)) return others(m, d, contacts, g1, g2, margin);
    std::string fault;
    bool off_centre = false;
    int count = 0;
    try {
        Geom a, b;
        if (!read(m, d, g1, a) || !read(m, d, g2, b)) return others(m, d, contacts, g1, g2, margin);
        std::array<Point, mjMAXCONPAIR> points;
        const auto slots = std::clamp(mj_maxContact(m, g1, g2, margin > 0), 0, mjMAXCONPAIR);
        count = int(find_points(a, b, margin, std::span(points).first(std::size_t(slots)), off_centre));
        for (int i = 0; i < count; ++i) {
            const Point& p = points[std::size_t(i)];
            mjPreContact& to = contacts[i];
            std::memset(&to, 0, sizeof to); // MuJoCo makes the tangents
            to.dist = p.distance;
            std::ranges::copy(p.position, to.pos);
            std::ranges::copy(p.normal, to.normal);
        }
    } catch (const std::exception& error) {
        fault = error.what();
    }
    if (!fault.empty()) fail(m, g1, g2, fault);
    static std::atomic_flag told;
    if (off_centre && !told.test_and_set())
        mju_warning("raycontact: the centre of mass of geom %d or %d is not that of its mesh as drawn; give meshes "
                    "inertia=\"exact\". Told once.",
                    g1, g2);
    return count;
}

bool is_mesh(mjtGeom type) {
    return type == mjGEOM_MESH || type == mjGEOM_SDF;
}

} // namespace

extern "C" {

/// Puts our functions in place of MuJoCo's. Doing so twice is doing so once.
RAYCONTACT_API void raycontact_mujoco_install() {
    if (installed) return;
    installed = true;
    for (const mjtGeom one : partners)
        for (const mjtGeom other : partners) {
            if (one > other || !(is_mesh(one) || is_mesh(other))) continue; // the table's upper half
            mjfCollision& entry = mjCOLLISIONFUNC[one][other];
            before[one][other] = std::exchange(entry, collide);
        }
}

/// Puts back what was there, and forgets all shapes.
RAYCONTACT_API void raycontact_mujoco_uninstall() {
    if (!installed) return;
    installed = false;
    for (const mjtGeom one : partners)
        for (const mjtGeom other : partners)
            if (one <= other && (is_mesh(one) || is_mesh(other)) && mjCOLLISIONFUNC[one][other] == collide)
                mjCOLLISIONFUNC[one][other] = before[one][other];
    raycontact::mujoco::forget_shapes();
}

/// Three numbers: calls, contacts told, contacts left out.
RAYCONTACT_API void raycontact_mujoco_counts(unsigned long long* three) {
    const auto counts = raycontact::mujoco::counts();
    three[0] = counts.calls;
    three[1] = counts.contacts;
    three[2] = counts.left_out;
}

} // extern "C"

mjPLUGIN_LIB_INIT(raycontact) {
    raycontact_mujoco_install();
}
