// SPDX-License-Identifier: Apache-2.0
#include "property/crowds.h"

#include "property/ray_sources.h"
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include "prepared_shape.h"
#include "scenes/models/model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>

namespace raycontact::reference {

namespace {

Mesh stretched(Mesh mesh, const Vec3& by) {
    for (Vec3& v : mesh.vertices) v = {by.x * v.x, by.y * v.y, by.z * v.z};
    return mesh;
}

Mesh inside_out(Mesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

Mesh joined(Mesh mesh, const Mesh& other) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
    return mesh;
}

Mesh model(const char* kind, std::uint32_t triangles) {
    return scenes::scene_model(kind, triangles).mesh;
}

// A flat double cone of 2 n slivers.
Mesh fan_mesh(std::uint32_t n) {
    Mesh mesh;
    mesh.name = "fan";
    mesh.vertices = {{0, 0, 0.01}, {0, 0, -0.01}};
    for (std::uint32_t i = 0; i < n; ++i) {
        const double angle = 6.283185307179586 * i / n;
        mesh.vertices.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle), 0});
        mesh.triangles.push_back({0, 2 + i, 2 + (i + 1) % n});
        mesh.triangles.push_back({1, 2 + (i + 1) % n, 2 + i});
    }
    return mesh;
}

std::vector<Mesh> concave_meshes() {
    return {model("knot", 302),   model("gear", 302),       model("torus", 202),
            model("sphere", 400), bumpy_octahedron_mesh(5), frame_mesh(),
            l_prism_mesh(),       tetrahedron_mesh(),       bumpy_octahedron_mesh(10)};
}

std::vector<Mesh> meshes_of(Kind kind) {
    const Mesh bumpy = bumpy_octahedron_mesh(5);
    std::vector<Mesh> meshes;
    switch (kind) {
    case Kind::concave:
        return concave_meshes();
    case Kind::cavities:
        return {joined(grid_box_mesh(4), inside_out(moved(stretched(bumpy, {0.3, 0.3, 0.3}), {0.5, 0.5, 0.5}))),
                joined(bumpy, inside_out(stretched(bumpy, {0.9, 0.9, 0.9}))),
                joined(box_mesh({0.6, 0.6, 0.4}),
                       inside_out(moved(stretched(l_prism_mesh(), {0.5, 0.5, 0.5}), {-0.25, -0.25, -0.1}))),
                frame_mesh(), bumpy};
    case Kind::open:
        meshes = {bowl_mesh(8), sheet_mesh(8), open_box_mesh(4), stretched(sheet_mesh(6), {0.5, 0.5, 0}),
                  bumpy,        l_prism_mesh()};
        meshes.push_back(needle());
        meshes.back() = stretched(meshes.back(), {250, 250, 1});
        return meshes;
    case Kind::crossing:
        meshes = {joined(bumpy, moved(bumpy, {0.4, 0.3, 0.1})),
                  joined(box_mesh({0.7, 0.1, 0.1}), box_mesh({0.1, 0.7, 0.15})), inside_out(bumpy), frame_mesh(),
                  bumpy};
        meshes.push_back(l_prism_mesh());
        std::swap(meshes.back().triangles[3][0], meshes.back().triangles[3][1]);
        return meshes;
    case Kind::slivers:
        return {stretched(bumpy, {1, 0.02, 1}),
                stretched(bumpy, {1, 0.05, 0.001}),
                stretched(l_prism_mesh(), {0.002, 0.002, 4}),
                fan_mesh(150),
                stretched(model("torus", 202), {1, 1, 0.01}),
                bumpy,
                tetrahedron_mesh()};
    case Kind::slab:
        meshes = concave_meshes();
        meshes.insert(meshes.begin(), box_mesh({21, 21, 1}));
        return meshes;
    case Kind::sizes:
        for (const double size : {0.01, 0.1, 1.0, 10.0})
            for (const Mesh& mesh : {bumpy, frame_mesh(), model("knot", 302)})
                meshes.push_back(stretched(mesh, {size, size, size}));
        return meshes;
    case Kind::coarse:
        return {box_mesh({0.5, 0.5, 0.5}),
                box_mesh({1, 0.1, 0.15}),
                box_mesh({0.6, 0.6, 0.05}),
                tetrahedron_mesh(),
                cone_mesh(),
                l_prism_mesh(),
                frame_mesh(),
                bumpy,
                model("gear", 302)};
    }
    return meshes;
}

// 10^x for x uniform between the two.
double some_power_of_ten(double low, double high, Random& random) {
    return std::pow(10.0, random.uniform(low, high));
}

} // namespace

const char* name_of(Kind kind) {
    constexpr const char* names[] = {"concave", "cavities", "open", "crossing", "slivers", "slab", "sizes", "coarse"};
    return names[static_cast<std::size_t>(kind)];
}

const char* name_of(Course course) {
    constexpr const char* names[] = {"drift",  "jitter", "spin",     "creep",   "approach",
                                     "tumble", "still",  "teleport", "sheared", "mixed"};
    static_assert(std::size(names) == std::size(courses));
    return names[static_cast<std::size_t>(course)];
}

const std::vector<std::shared_ptr<const Shape>>& crowd_shapes(Kind kind, double scale) {
    static std::map<std::tuple<Kind, double>, std::vector<std::shared_ptr<const Shape>>> made;
    auto& shapes = made[{kind, scale}];
    if (shapes.empty())
        for (const Mesh& mesh : meshes_of(kind))
            shapes.push_back(
                prepared_shape(prepare_mesh(stretched(mesh, {scale, scale, scale}), {.repair = Repair::as_is})));
    return shapes;
}

Pose composed(const Pose& outer, const Pose& inner) {
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            pose.rotation[3 * i + j] = 0;
            for (std::size_t k = 0; k < 3; ++k)
                pose.rotation[3 * i + j] += outer.rotation[3 * i + k] * inner.rotation[3 * k + j];
        }
    pose.translation = outer.translation + rotate(outer, inner.translation);
    return pose;
}

Pose rounded_to_float(Pose pose) {
    const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    for (double& r : pose.rotation) r = rounded(r);
    pose.translation = {rounded(pose.translation.x), rounded(pose.translation.y), rounded(pose.translation.z)};
    return pose;
}

Pose sheared(Pose pose, Random& random) {
    Pose shear; // twice an entry is what a check of R^T R sees
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double by = random.uniform(-4.4e-5, 4.4e-5);
            shear.rotation[3 * i + j] += by;
            if (i != j) shear.rotation[3 * j + i] += by;
        }
    const Vec3 at = pose.translation;
    pose.translation = {};
    pose = composed(pose, shear);
    pose.translation = at;
    return pose;
}

Mover::Mover(Course course, const Pose& home, double size, Random& random)
    : course_(course), home_(home), pose_(home), size_(size), way_(random.direction()), axis_(random.direction()) {
    if (course == Course::mixed) course_ = courses[random.below(std::size(courses) - 1)];
    speed_ = size * some_power_of_ten(-5, -2, random);
    rate_ = some_power_of_ten(-5, -2, random);
    if (course_ == Course::jitter || course_ == Course::sheared) {
        rate_ = some_power_of_ten(-7, -3, random);
        speed_ = size * rate_;
    }
    if (course_ == Course::spin) rate_ = some_power_of_ten(-3, -1, random);
    period_ = 20 + static_cast<int>(random.below(200));
}

Pose Mover::next(Random& random) {
    ++step_;
    const Vec3 at = pose_.translation;
    const auto turned = [](const Pose& pose, const Vec3& axis, double angle) {
        Pose result = composed(small_rotation(axis, angle), pose);
        result.translation = pose.translation;
        return result;
    };
    switch (course_) {
    case Course::drift:
        if (dot(at - home_.translation, way_) > 0.3 * size_) speed_ = -std::fabs(speed_);
        if (dot(at - home_.translation, way_) < -0.3 * size_) speed_ = std::fabs(speed_);
        pose_ = turned(pose_, axis_, rate_);
        pose_.translation = at + speed_ * way_;
        break;
    case Course::jitter:
    case Course::sheared: {
        const Vec3 axis = random.direction(); // one after the other: the order of arguments is the compiler's
        pose_ = turned(home_, axis, rate_ * random.uniform());
        pose_.translation = home_.translation + speed_ * random.in_ball();
        if (course_ == Course::sheared) return sheared(pose_, random);
        break;
    }
    case Course::spin:
        pose_ = turned(pose_, axis_, rate_);
        break;
    case Course::creep:
        if (step_ % 10 == 1) {
            constexpr double paces[] = {1e-5, 2e-4, 8e-4, 1.6e-3, 4e-3};
            rate_ = paces[random.below(std::size(paces))];
            way_ = random.direction();
            axis_ = random.direction();
        }
        pose_ = turned(pose_, axis_, rate_);
        pose_.translation = at + rate_ * size_ * way_;
        break;
    case Course::approach: {
        const int phase = step_ % period_;
        const double away = std::fabs(2.0 * phase / period_ - 1); // 1 -> 0 -> 1
        pose_ = turned(pose_, axis_, 0.1 * rate_);
        pose_.translation = home_.translation + 0.5 * size_ * away * way_;
        break;
    }
    case Course::tumble: {
        const Vec3 axis = random.direction();
        pose_ = turned(pose_, axis, random.uniform(0.1, 6));
        pose_.translation = home_.translation + 0.2 * size_ * random.in_ball();
        break;
    }
    case Course::teleport:
        if (random.below(12) == 0) {
            pose_ = random.rotation();
            const double how_far = random.below(8) == 0 ? 1e4 : 1;
            pose_.translation = home_.translation + how_far * size_ * random.in_ball();
        } else if (random.below(12) == 0) {
            pose_ = home_;
        } else {
            pose_.translation = at + 1e-4 * size_ * random.in_ball();
        }
        break;
    case Course::still:
    case Course::mixed:
        break;
    }
    return pose_;
}

std::vector<Pose> touching_poses(const std::vector<std::shared_ptr<const Shape>>& shapes, double tightness,
                                 Random& random) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        Pose pose = random.rotation();
        const Vec3 size = shapes[i]->box_max() - shapes[i]->box_min();
        Vec3 goal;
        if (i > 0) {
            // Beside a point of an earlier body's surface.
            const std::size_t other = random.below(static_cast<std::uint32_t>(i));
            const auto& triangles = shapes[other]->triangles();
            const auto& [a, b, c] = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
            const auto vertices = shapes[other]->vertices();
            const double u = random.uniform();
            const double v = random.uniform();
            const Vec3 point =
                vertices[a] + u * (vertices[b] - vertices[a]) + (1 - u) * v * (vertices[c] - vertices[a]);
            goal = transform_point(poses[other], point) + tightness * length(size) * random.direction();
        }
        pose.translation = goal - rotate(pose, shapes[i]->centre());
        poses.push_back(pose);
    }
    return poses;
}

} // namespace raycontact::reference
