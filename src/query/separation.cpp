// SPDX-License-Identifier: Apache-2.0
#include <raycontact/separation.h>

#include "executor/float_environment.h"
#include "query/checks.h"
#include "query/hull_exit.h"
#include "query/impacts.h"
#include "query/inside.h"
#include "query/surfaces.h"

#include <raycontact/collide.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace raycontact {

namespace {

/// By how much a translation may be too long, of what is least for two convex meshes.
constexpr double share = 0.005;
/// What is left between meshes that are parted, of the smaller one's diagonal.
constexpr double gap_share = 1e-6;
constexpr int most_pushes = 12;
/// Of the deepest contacts, whose normals are ways to try.
constexpr std::size_t most_contacts = 8;

/// Turns inward at no edge, so that no way out is shorter than that of the hull.
bool is_convex(const ShapeData& shape) {
    if (shape.round) return true;
    if (shape.component_vertices.size() != 1 || !shape.rays_end) return false;
    for (std::uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) {
        const Vec3 normal{shape.face_normals[t].x, shape.face_normals[t].y, shape.face_normals[t].z};
        for (const std::uint32_t other : shape.neighbours[t]) {
            if (other == NONE) return false;
            for (std::size_t k = 0; k < 3; ++k)
                if (dot(normal, shape.corner(other, k) - shape.corner(t, 0)) > 1e-6 * shape.diagonal) return false;
        }
    }
    return true;
}

// Of a round shape those of its core.
std::vector<Vec3> placed_vertices(const Shape& shape, const Pose& pose, const Vec3& origin) {
    const ShapeData& mesh = queried(shape);
    std::vector<Vec3> points;
    for (std::uint32_t v = 0; v < mesh.mesh.vertices.size(); ++v)
        points.push_back(rotated(pose.rotation, mesh.file_vertex(v)) + (pose.translation - origin));
    return points;
}

// Of a round body one contact: out where its core is nearest to the surface of the other. None where it is on it.
std::vector<Contact> contacts_of(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    if (a.round() == nullptr && b.round() == nullptr) return collide(a, pose_a, b, pose_b);
    const ShapePair pair(a, pose_a, b, pose_b);
    const auto closest = *closest_triangles(pair, any_distance);
    const Vec3 apart = rotated(pose_b.rotation, closest.point_b - closest.point_a);
    const bool is_inside = vertex_inside(pair) || vertex_inside(ShapePair(b, pose_b, a, pose_a));
    const double depth = pair.radius() + (is_inside ? length(apart) : -length(apart));
    if (!(depth > 0) || apart == Vec3{}) return {};
    const Vec3 normal = (is_inside ? -1.0 : 1.0) * unit(apart);
    Contact contact;
    contact.normal = {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)};
    contact.depth = static_cast<float>(depth);
    return {contact};
}

/// Ways by which the second mesh leaves the first; at the beginning that out of their hulls.
class Exits {
public:
    Exits(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b)
        : a_(a), b_(b), stays_(no_motion(pose_a)), begin_(nearest_rigid_pose(pose_b)),
          hulls_(placed_vertices(a, pose_a, pose_b.translation), placed_vertices(b, pose_b, pose_b.translation),
                 radius_of(queried(a)) + radius_of(queried(b))),
          gap_(gap_share * std::min(a.data().diagonal, b.data().diagonal)) {
        const HullExit exit = hulls_.shortest(share, std::max(a.data().diagonal, b.data().diagonal));
        const double metres = std::max(exit.metres, 0.0) + 2 * gap_;
        const auto there = distance(a, stays_.from, b, place(metres * exit.way));
        best_ = {exit.way, metres, {0, there->distance, there->point_a, there->point_b, {}}};
        try_back(exit.way, metres);
    }

    struct Exit {
        Vec3 way; ///< unit
        double metres;
        Impact last; ///< what is met there on the way back
    };
    const Exit& best() const { return best_; }

    /// By the deepest contact, again and again: out of a hole that a hull does not know. contacts: where b is.
    void try_pushes(std::vector<Contact> contacts) {
        Vec3 pushed;
        for (int round = 0; round < most_pushes && !contacts.empty(); ++round) {
            const Contact& deepest = *std::ranges::max_element(contacts, {}, &Contact::depth);
            pushed = pushed + (double(deepest.depth) + 2 * gap_) * unit(deepest.normal);
            if (is_free(pushed)) {
                if (length(pushed) < best_.metres) try_back(unit(pushed), length(pushed));
                return;
            }
            contacts = contacts_of(a_, stays_.from, b_, place(pushed));
        }
    }

    /// Whether a way is shorter than the best one: it is free at the end of that.
    bool try_way(const Vec3& way) {
        return way != Vec3{} && is_free(best_.metres * way) && try_back(way, best_.metres);
    }

    /// By the normals of what is met, while that helps.
    void follow_normals() {
        constexpr int most = 16;
        for (int round = 0; round < most && try_way(best_.last.normal); ++round) {
        }
    }

    /// By ways around the best, nearer and nearer to it.
    void look_around() {
        for (double turn = 0.3; turn > 0.01; turn *= 0.5) {
            for (bool shorter = true; shorter; follow_normals()) {
                const Vec3 way = best_.way;
                const Vec3 side = unit(cross(way, std::fabs(way.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
                const Vec3 up = cross(way, side);
                shorter = false;
                for (const auto& [s, u] : {std::pair{1, 0}, {0, 1}, {-1, 0}, {0, -1}})
                    shorter = shorter || try_way(unit(way + turn * (double(s) * side + double(u) * up)));
            }
        }
    }

    double gap() const { return gap_; }

private:
    Pose place(const Vec3& translation) const {
        Pose pose = begin_;
        pose.translation = pose.translation + translation;
        return pose;
    }
    bool is_free(const Vec3& translation) const {
        return !distance(a_, stays_.from, b_, place(translation), 1.5 * gap_);
    }

    // Comes back from where they are apart to where something is met. Whether that is shorter by more than next to
    // nothing.
    bool try_back(const Vec3& way, double metres) {
        const RigidMotion motion{place(metres * way), -metres * way, {}, {}};
        const auto met = impact_on_the_way(a_, stays_, b_, motion, {0, gap_});
        const double shorter = met ? metres * (1 - met->time) : metres;
        if (!met || shorter >= best_.metres) return false;
        const bool tells = shorter < 0.9999 * best_.metres;
        best_ = {way, shorter, *met};
        return tells;
    }

    const Shape &a_, &b_;
    RigidMotion stays_;
    Pose begin_;
    HullExits hulls_;
    double gap_;
    Exit best_;
};

std::vector<Vec3> normals_of_deepest(std::vector<Contact> contacts) {
    const std::size_t count = std::min(contacts.size(), most_contacts);
    std::ranges::partial_sort(contacts, contacts.begin() + std::ptrdiff_t(count), std::ranges::greater{},
                              &Contact::depth);
    std::vector<Vec3> normals;
    Vec3 sum;
    for (std::size_t i = 0; i < count; ++i) {
        normals.push_back(unit(contacts[i].normal));
        sum = sum + double(contacts[i].depth) * normals.back();
    }
    normals.push_back(unit(sum));
    return normals;
}

} // namespace

Separation separation(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const FloatEnvironment environment;
    const auto apart = *distance(a, pose_a, b, pose_b);
    if (apart.distance > 0)
        return {apart.distance, normal_between(a, pose_a, b, pose_b, apart), apart.point_a, apart.point_b};
    Exits exits(a, pose_a, b, pose_b);
    exits.follow_normals();
    if (!is_convex(a.data()) || !is_convex(b.data())) {
        const std::vector<Contact> contacts = contacts_of(a, pose_a, b, pose_b);
        exits.try_pushes(contacts);
        for (const Vec3& normal : normals_of_deepest(contacts)) exits.try_way(normal);
        for (const double x : {-1, 0, 1})
            for (const double y : {-1, 0, 1})
                for (const double z : {-1, 0, 1}) exits.try_way(unit(rotated(pose_a.rotation, {x, y, z})));
        exits.follow_normals();
        exits.look_around();
    }
    const Exits::Exit& exit = exits.best();
    // What rounding leaves to be done.
    double metres = exit.metres;
    Pose parted = pose_b;
    for (double more = exits.gap();; more *= 2) {
        parted.translation = pose_b.translation + metres * exit.way;
        if (!intersects(a, pose_a, b, parted)) break;
        metres = exit.metres + more;
    }
    return {-metres, exit.way, exit.last.point_a, exit.last.point_b - metres * exit.way};
}

} // namespace raycontact
