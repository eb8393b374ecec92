// SPDX-License-Identifier: Apache-2.0
#include <raycontact/mass.h>
#include <stand_in.h>
#include <vectors.h>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace raycontact::bullet {

namespace {

constexpr std::uint32_t sides = 64;      ///< of a cylinder and a cone: facets within 6e-4 of the radius
constexpr std::uint32_t ball_parts = 10; ///< of each edge of the icosahedron: 1002 points, within 1.5e-3 of the radius
constexpr double pi = 3.14159265358979323846;

/// A ring of points about the z axis. Corners and the middles of chords are equally far off the circle.
void add_ring(Mesh& mesh, double radius, double z) {
    const double corner = radius * 2 / (1 + std::cos(pi / sides));
    for (std::uint32_t k = 0; k < sides; ++k) {
        const double angle = 2 * pi * k / sides;
        mesh.vertices.push_back({corner * std::cos(angle), corner * std::sin(angle), z});
    }
}

/// Closes a ring of points that begins at `first`, seen counter-clockwise from above.
void add_lid(Mesh& mesh, std::uint32_t first, bool up) {
    for (std::uint32_t k = 1; k + 1 < sides; ++k) {
        if (up)
            mesh.triangles.push_back({first, first + k, first + k + 1});
        else
            mesh.triangles.push_back({first, first + k + 1, first + k});
    }
}

/// From the z axis to another one; a rotation, so windings stay.
void turn_up(Mesh& mesh, int axis) {
    if (axis == 2) return;
    for (Vec3& v : mesh.vertices) v = axis == 0 ? Vec3{v.z, v.x, v.y} : Vec3{v.y, v.z, v.x};
}

Mesh box(const btVector3& half) {
    Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.vertices.push_back({double(half.x()) * (k & 1 ? 1 : -1), double(half.y()) * (k & 2 ? 1 : -1),
                                 double(half.z()) * (k & 4 ? 1 : -1)});
    const std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& f : faces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

Mesh cylinder(double radius, double half, int axis) {
    Mesh mesh;
    add_ring(mesh, radius, -half);
    add_ring(mesh, radius, half);
    add_lid(mesh, 0, false);
    add_lid(mesh, sides, true);
    for (std::uint32_t k = 0; k < sides; ++k) {
        const std::uint32_t next = (k + 1) % sides;
        mesh.triangles.push_back({k, next, sides + next});
        mesh.triangles.push_back({k, sides + next, sides + k});
    }
    turn_up(mesh, axis);
    return mesh;
}

Mesh cone(double radius, double height, int axis) {
    Mesh mesh;
    add_ring(mesh, radius, -height / 2);
    mesh.vertices.push_back({0, 0, height / 2});
    add_lid(mesh, 0, false);
    for (std::uint32_t k = 0; k < sides; ++k) mesh.triangles.push_back({k, (k + 1) % sides, sides});
    turn_up(mesh, axis);
    return mesh;
}

/// An icosahedron's faces divided and blown up to the unit sphere, then a little more: corners and the middles of the
/// largest facets are equally far off it.
std::vector<Vec3> make_ball() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    const std::array<Vec3, 12> corners{{{-1, g, 0},
                                        {1, g, 0},
                                        {-1, -g, 0},
                                        {1, -g, 0},
                                        {0, -1, g},
                                        {0, 1, g},
                                        {0, -1, -g},
                                        {0, 1, -g},
                                        {g, 0, -1},
                                        {g, 0, 1},
                                        {-g, 0, -1},
                                        {-g, 0, 1}}};
    const std::array<std::array<std::size_t, 3>, 20> faces{
        {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
         {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
         {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
    std::vector<Vec3> points;
    double nearest = 1;
    for (const auto& f : faces) {
        const Vec3 &a = corners[f[0]], &b = corners[f[1]], &c = corners[f[2]];
        const auto at = [&](std::uint32_t i, std::uint32_t k) {
            const double u = double(i) / ball_parts, v = double(k) / ball_parts, w = 1 - u - v;
            const Vec3 p{w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y, w * a.z + u * b.z + v * c.z};
            const double length = std::sqrt(dot(p, p));
            return Vec3{p.x / length, p.y / length, p.z / length};
        };
        const auto facet = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
            const Vec3 n = cross(q - p, r - p);
            nearest = std::min(nearest, std::fabs(dot(n, p)) / std::sqrt(dot(n, n)));
        };
        for (std::uint32_t i = 0; i <= ball_parts; ++i) {
            for (std::uint32_t k = 0; i + k <= ball_parts; ++k) {
                points.push_back(at(i, k));
                if (i + k < ball_parts) facet(at(i, k), at(i + 1, k), at(i, k + 1));
                if (i + k + 1 < ball_parts) facet(at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
            }
        }
    }
    for (Vec3& p : points) p = {p.x * 2 / (1 + nearest), p.y * 2 / (1 + nearest), p.z * 2 / (1 + nearest)};
    return points;
}

/// Without triangles where the points lie in a plane.
Mesh hull(const std::vector<Vec3>& points) {
    Mesh mesh;
    if (points.size() < 4) return mesh;
    btConvexHullComputer computer;
    computer.compute(&points[0].x, static_cast<int>(sizeof(Vec3)), static_cast<int>(points.size()), 0, 0);
    // Its own vertices are rounded to 1e-4 of the size: the points given are taken instead.
    for (int i = 0; i < computer.vertices.size(); ++i)
        mesh.vertices.push_back(points[static_cast<std::size_t>(computer.original_vertex_index[i])]);
    for (int i = 0; i < computer.faces.size(); ++i) {
        const btConvexHullComputer::Edge* const begin = &computer.edges[computer.faces[i]];
        const auto first = static_cast<std::uint32_t>(begin->getSourceVertex());
        for (const auto* edge = begin->getNextEdgeOfFace(); edge->getTargetVertex() != static_cast<int>(first);
             edge = edge->getNextEdgeOfFace())
            mesh.triangles.push_back({first, static_cast<std::uint32_t>(edge->getSourceVertex()),
                                      static_cast<std::uint32_t>(edge->getTargetVertex())});
    }
    const double volume = mass_of(mesh.vertices, mesh.triangles).volume;
    if (volume < 0)
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    double size = 0;
    for (const Vec3& v : mesh.vertices) {
        const Vec3 across = v - mesh.vertices[0];
        size = std::max(size, dot(across, across));
    }
    if (!(std::fabs(volume) > 1e-6 * std::pow(size, 1.5))) return {};
    return mesh;
}

std::vector<Vec3> hull_points(const btConvexHullShape& shape) {
    std::vector<Vec3> points;
    points.reserve(static_cast<std::size_t>(shape.getNumPoints()));
    for (int i = 0; i < shape.getNumPoints(); ++i) points.push_back(to_vec(shape.getScaledPoint(i)));
    return points;
}

/// The hull of its balls is as near to the true surface as they are.
std::vector<Vec3> ball_points(const btMultiSphereShape& shape) {
    static const std::vector<Vec3> ball = make_ball();
    const Vec3 scaling = to_vec(shape.getLocalScaling());
    std::vector<Vec3> points;
    for (int i = 0; i < shape.getSphereCount(); ++i) {
        const Vec3 centre = to_vec(shape.getSpherePosition(i));
        const double radius = double(shape.getSphereRadius(i));
        for (const Vec3& p : ball)
            points.push_back({(centre.x + radius * p.x) * scaling.x, (centre.y + radius * p.y) * scaling.y,
                              (centre.z + radius * p.z) * scaling.z});
    }
    return points;
}

} // namespace

std::vector<btScalar> surface_numbers(const btCollisionShape& shape) {
    std::vector<btScalar> numbers{btScalar(shape.getShapeType())};
    const auto add = [&](const btVector3& v) { numbers.insert(numbers.end(), {v.x(), v.y(), v.z()}); };
    switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
        add(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
        break;
    case CYLINDER_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btCylinderShape&>(shape);
        add(s.getHalfExtentsWithMargin());
        numbers.push_back(btScalar(s.getUpAxis()));
        break;
    }
    case CONE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btConeShape&>(shape);
        numbers.insert(numbers.end(), {s.getRadius(), s.getHeight(), btScalar(s.getConeUpIndex())});
        break;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btConvexHullShape&>(shape);
        for (int i = 0; i < s.getNumPoints(); ++i) add(s.getScaledPoint(i));
        break;
    }
    case MULTI_SPHERE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btMultiSphereShape&>(shape);
        add(s.getLocalScaling());
        for (int i = 0; i < s.getSphereCount(); ++i) {
            add(s.getSpherePosition(i));
            numbers.push_back(s.getSphereRadius(i));
        }
        break;
    }
    default:
        break;
    }
    return numbers;
}

Mesh stand_in(const btCollisionShape& shape) {
    Mesh mesh;
    switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
        mesh = box(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin().absolute());
        break;
    case CYLINDER_SHAPE_PROXYTYPE: {
        // As Bullet's own support function has it, one of the two half extents across is the radius.
        const auto& s = static_cast<const btCylinderShape&>(shape);
        mesh = cylinder(double(s.getRadius()), double(s.getHalfExtentsWithMargin()[s.getUpAxis()]), s.getUpAxis());
        break;
    }
    case CONE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btConeShape&>(shape);
        mesh = cone(double(s.getRadius()), double(s.getHeight()), s.getConeUpIndex());
        break;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE:
        mesh = hull(hull_points(static_cast<const btConvexHullShape&>(shape)));
        break;
    case MULTI_SPHERE_SHAPE_PROXYTYPE:
        mesh = hull(ball_points(static_cast<const btMultiSphereShape&>(shape)));
        break;
    default:
        break;
    }
    mesh.name = shape.getName();
    return mesh;
}

} // namespace raycontact::bullet
