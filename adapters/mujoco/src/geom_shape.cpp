// SPDX-License-Identifier: Apache-2.0
#include "geom_shape.h"

#include <raycontact/mass.h>
#include <raycontact/mesh.h>
#include <raycontact/primitives.h>

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <list>
#include <mutex>
#include <unordered_map>

namespace raycontact::mujoco {

namespace {

constexpr double pi = 3.14159265358979323846;
// Of what is round: chords leave its surface by 1 / 1 300 of the radius at most, half outward, half inward.
constexpr int around = 64;

/// A surface of revolution about z: rings of `around` vertices at heights and radii, closed by two poles.
Mesh turned(const std::vector<std::array<double, 2>>& rings, double low, double high, double x, double y) {
    Mesh mesh;
    const auto ring = [](std::size_t r, int i) {
        return static_cast<std::uint32_t>(r) * around + static_cast<std::uint32_t>(i % around);
    };
    for (const auto& [radius, height] : rings)
        for (int i = 0; i < around; ++i)
            mesh.vertices.push_back(
                {x * radius * std::cos(2 * pi * i / around), y * radius * std::sin(2 * pi * i / around), height});
    const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size()), top = bottom + 1;
    mesh.vertices.push_back({0, 0, low});
    mesh.vertices.push_back({0, 0, high});
    for (int i = 0; i < around; ++i) {
        mesh.triangles.push_back({bottom, ring(0, i + 1), ring(0, i)});
        mesh.triangles.push_back({top, ring(rings.size() - 1, i), ring(rings.size() - 1, i + 1)});
        for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
            mesh.triangles.push_back({ring(r, i), ring(r, i + 1), ring(r + 1, i + 1)});
            mesh.triangles.push_back({ring(r, i), ring(r + 1, i + 1), ring(r + 1, i)});
        }
    }
    return mesh;
}

/// The solid that MuJoCo's height field is: down to its base.
Mesh height_field(const Geom& geom) {
    Mesh mesh;
    const int rows = geom.rows, columns = geom.columns;
    const auto [x, y, high, base] = geom.size;
    const auto corner = [&](int layer, int r, int c) {
        return static_cast<std::uint32_t>((layer * rows + r) * columns + c);
    };
    for (const int layer : {0, 1})
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < columns; ++c) {
                const double height =
                    layer == 0 ? high * double(geom.vertices[std::size_t(r) * std::size_t(columns) + std::size_t(c)])
                               : -base;
                mesh.vertices.push_back({x * (2.0 * c / (columns - 1) - 1), y * (2.0 * r / (rows - 1) - 1), height});
            }
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (int r = 0; r + 1 < rows; ++r)
        for (int c = 0; c + 1 < columns; ++c) {
            quad(corner(0, r, c), corner(0, r, c + 1), corner(0, r + 1, c + 1), corner(0, r + 1, c));
            quad(corner(1, r, c), corner(1, r + 1, c), corner(1, r + 1, c + 1), corner(1, r, c + 1));
        }
    for (int c = 0; c + 1 < columns; ++c) {
        quad(corner(1, 0, c), corner(1, 0, c + 1), corner(0, 0, c + 1), corner(0, 0, c));
        quad(corner(0, rows - 1, c), corner(0, rows - 1, c + 1), corner(1, rows - 1, c + 1), corner(1, rows - 1, c));
    }
    for (int r = 0; r + 1 < rows; ++r) {
        quad(corner(0, r, 0), corner(0, r + 1, 0), corner(1, r + 1, 0), corner(1, r, 0));
        quad(corner(1, r, columns - 1), corner(1, r + 1, columns - 1), corner(0, r + 1, columns - 1),
             corner(0, r, columns - 1));
    }
    return mesh;
}

Mesh mesh_of(const Geom& geom) {
    // Half of what a chord cuts off lies outside of the round surface.
    const double grown = 2 / (1 + std::cos(pi / around));
    switch (geom.kind) {
    case Geom::Kind::height_field:
        return height_field(geom);
    case Geom::Kind::cylinder: {
        const double radius = grown * geom.size[0], half = geom.size[1];
        return turned({{radius, -half}, {radius, half}}, -half, half, 1, 1);
    }
    case Geom::Kind::ellipsoid: {
        std::vector<std::array<double, 2>> rings;
        for (int i = 1; i < around / 2; ++i) {
            const double turn = 2 * pi * i / around;
            rings.push_back({grown * std::sin(turn), -grown * geom.size[2] * std::cos(turn)});
        }
        return turned(rings, -grown * geom.size[2], grown * geom.size[2], geom.size[0], geom.size[1]);
    }
    default:
        break;
    }
    std::vector<std::uint32_t> faces(geom.faces.begin(), geom.faces.end());
    return make_mesh(geom.vertices, faces, "geom");
}

std::shared_ptr<const Shape> make_shape(const Geom& geom) {
    switch (geom.kind) {
    case Geom::Kind::ball:
        return make_ball(geom.size[0]);
    case Geom::Kind::capsule:
        return make_capsule(geom.size[0], geom.size[1]);
    case Geom::Kind::box:
        return make_box({geom.size[0], geom.size[1], geom.size[2]});
    default:
        return Shape::make(mesh_of(geom));
    }
}

// MuJoCo puts a mesh's origin at the centre of mass that it computed, by default of a volume that concave meshes lack.
bool is_off_centre(const Shape& shape) {
    if (!shape.has_inside()) return false;
    const Vec3 centre = mass_of(shape.file_vertices(), shape.triangles()).centre, low = shape.box_min(),
               high = shape.box_max();
    const auto size = [](double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); };
    return size(centre.x, centre.y, centre.z) > 1e-3 * size(high.x - low.x, high.y - low.y, high.z - low.z);
}

struct Key {
    std::uint64_t low, high;
    bool operator==(const Key&) const = default;
};
struct KeyHash {
    std::size_t operator()(const Key& key) const { return static_cast<std::size_t>(key.low); }
};

Key key_of(const Geom& geom) {
    const std::array<std::uint64_t, 4> head{std::uint64_t(geom.kind), geom.vertices.size(), geom.faces.size(),
                                            std::uint64_t(geom.columns)};
    XXH64_hash_t seed = XXH3_64bits(head.data(), sizeof head);
    if (geom.kind != Geom::Kind::mesh) seed ^= XXH3_64bits(geom.size.data(), sizeof geom.size);
    const XXH128_hash_t of_vertices = XXH3_128bits_withSeed(geom.vertices.data(), geom.vertices.size_bytes(), seed);
    const XXH128_hash_t all = XXH3_128bits_withSeed(geom.faces.data(), geom.faces.size_bytes(), of_vertices.low64);
    return {all.low64 ^ of_vertices.high64, all.high64};
}

/// The shapes used last.
class Shapes {
public:
    std::shared_ptr<const Shape> of(const Geom& geom, bool& off_centre) {
        const Key key = key_of(geom);
        {
            const std::scoped_lock lock(mutex_);
            if (const auto known = places_.find(key); known != places_.end()) {
                used_.splice(used_.begin(), used_, known->second);
                return known->second->shape;
            }
        }
        std::shared_ptr<const Shape> made = make_shape(geom); // two threads may make it twice: both have the same
        const std::scoped_lock lock(mutex_);
        if (const auto known = places_.find(key); known != places_.end()) return known->second->shape;
        used_.push_front({key, made});
        places_[key] = used_.begin();
        off_centre = off_centre || (geom.kind == Geom::Kind::mesh && is_off_centre(*made));
        if (used_.size() > most) {
            places_.erase(used_.back().key);
            used_.pop_back();
        }
        return made;
    }
    void clear() {
        const std::scoped_lock lock(mutex_);
        used_.clear();
        places_.clear();
    }

private:
    static constexpr std::size_t most = 4096;
    struct Known {
        Key key;
        std::shared_ptr<const Shape> shape;
    };
    std::mutex mutex_;
    std::list<Known> used_; ///< the one used last first
    std::unordered_map<Key, std::list<Known>::iterator, KeyHash> places_;
};

Shapes& shapes() {
    static Shapes* const all = new Shapes; // plugins are never unloaded: nothing dies before the last thread
    return *all;
}

} // namespace

std::shared_ptr<const Shape> shape_of(const Geom& geom, bool& off_centre) {
    std::shared_ptr<const Shape> shape = shapes().of(geom, off_centre);
    if (geom.is_field && !shape->is_prepared()) shape->prepare();
    return shape;
}

void forget_shapes() {
    shapes().clear();
}

} // namespace raycontact::mujoco
