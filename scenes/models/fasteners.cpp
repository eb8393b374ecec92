// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/fasteners.h>

#include <scenes/models/trigonometry.h>

#include <cmath>
#include <cstdint>

namespace raycontact::scenes {
namespace {

constexpr double mm = 0.001;
constexpr std::uint32_t points = 24; ///< of a ring; a multiple of six, so that the hexagon has its corners
constexpr double pitch = 3, core = 4.9, crest = 6.1, air = 0.1, across_flats = 18;
constexpr std::uint32_t rings_a_turn = 4;

/// Rings of points about the z axis, from ring to ring joined by triangles.
class Turned {
public:
    /// `upward`: whether rings follow each other along z; else quads are cut along their other diagonal, so that two
    /// surfaces that face each other are cut alike.
    Turned(const char* name, bool upward) : upward_(upward) { mesh_.name = name; }

    /// `radius`: in millimetres, of a turn from 0 to 1.
    template <class Radius>
    void add_ring(double z, Radius radius) {
        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        for (std::uint32_t i = 0; i < points; ++i) {
            const double turn = static_cast<double>(i) / points;
            const SineCosine at = sine_cosine(turn);
            add_vertex(radius(turn) * at.cosine, radius(turn) * at.sine, z);
        }
        if (rings_++ > 0) join(first - points, first);
    }
    /// Closes the end at the last ring, or at the first, by a point on the axis.
    void add_cap(double z, bool last) {
        const auto centre = static_cast<std::uint32_t>(mesh_.vertices.size());
        const std::uint32_t ring = last ? centre - points : 0;
        add_vertex(0, 0, z);
        for (std::uint32_t i = 0; i < points; ++i) {
            const std::uint32_t here = ring + i, next = ring + (i + 1) % points;
            mesh_.triangles.push_back(last ? std::array{centre, here, next} : std::array{centre, next, here});
        }
    }
    /// Joins the last ring to the first.
    void close() { join(static_cast<std::uint32_t>(mesh_.vertices.size()) - points, 0); }
    Mesh mesh() const { return mesh_; }

private:
    // Rounded to float32: a mesh written to any format and read again is the same mesh.
    void add_vertex(double x, double y, double z) {
        const auto rounded = [](double v) { return static_cast<double>(static_cast<float>(v * mm)); };
        mesh_.vertices.push_back({rounded(x), rounded(y), rounded(z)});
    }
    void join(std::uint32_t from, std::uint32_t to) {
        for (std::uint32_t i = 0; i < points; ++i) {
            const std::uint32_t next = (i + 1) % points;
            mesh_.triangles.push_back({from + i, from + next, to + (upward_ ? next : i)});
            mesh_.triangles.push_back({from + (upward_ ? i : next), to + next, to + i});
        }
    }

    Mesh mesh_;
    bool upward_;
    std::uint32_t rings_ = 0;
};

double hexagon(double turn) {
    const double sixth = turn * 6 - std::floor(turn * 6); // of a side, from corner to corner
    return across_flats / 2 / sine_cosine((sixth - 0.5) / 6).cosine;
}

/// Up and down once a pitch, and once a turn.
auto thread(double z, double wider) {
    return [=](double turn) {
        const double phase = z / pitch - turn, part = phase - std::floor(phase);
        return core + wider + (crest - core) * (part < 0.5 ? 2 * part : 2 - 2 * part);
    };
}

auto round(double radius) {
    return [=](double) { return radius; };
}

} // namespace

Mesh bolt() {
    constexpr double head = 8, shank_end = 15, thread_from = 16, end = 40;
    Turned bolt("bolt", true);
    bolt.add_ring(0, hexagon);
    bolt.add_ring(head, hexagon);
    bolt.add_ring(head, round(crest));
    bolt.add_ring(shank_end, round(crest));
    const auto rings = static_cast<std::uint32_t>(std::lround((end - 1 - thread_from) / pitch * rings_a_turn));
    for (std::uint32_t k = 0; k <= rings; ++k) {
        const double z = thread_from + k * pitch / rings_a_turn;
        bolt.add_ring(z, thread(z, 0));
    }
    bolt.add_ring(end, round(core - 0.5));
    bolt.add_cap(end, true);
    bolt.add_cap(0, false);
    return bolt.mesh();
}

Mesh nut() {
    constexpr double from = 22, height = 9;
    Turned nut("nut", false);
    const auto rings = static_cast<std::uint32_t>(std::lround(height / pitch * rings_a_turn));
    for (std::uint32_t k = 0; k <= rings; ++k) {
        const double z = from + height - k * pitch / rings_a_turn;
        nut.add_ring(z, thread(z, air));
    }
    nut.add_ring(from, hexagon);
    nut.add_ring(from + height, hexagon);
    nut.close();
    return nut.mesh();
}

} // namespace raycontact::scenes
