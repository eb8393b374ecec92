// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mass.h>
#include <raycontact/mesh.h>
#include <scenes/models/trigonometry.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace raycontact::scenes {

using Loop = std::vector<std::uint32_t>;

/// A mesh as it is put together: points, then what lies between them.
class Skin {
public:
    explicit Skin(const char* name) { mesh_.name = name; }

    std::uint32_t add(double x, double y, double z) {
        mesh_.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(mesh_.vertices.size()) - 1;
    }
    Loop add_ring(double radius, double z, std::uint32_t around) {
        Loop ring;
        for (std::uint32_t i = 0; i < around; ++i) {
            const SineCosine at = sine_cosine(static_cast<double>(i) / around);
            ring.push_back(add(radius * at.cosine, radius * at.sine, z));
        }
        return ring;
    }
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.push_back({a, b, c}); }
    void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    void join(const Loop& a, const Loop& b) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            const std::size_t next = (i + 1) % a.size();
            quad(a[i], a[next], b[next], b[i]);
        }
    }
    void fan(std::uint32_t tip, const Loop& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i) triangle(ring[i], ring[(i + 1) % ring.size()], tip);
    }
    /// All must be wound alike; turned outward here.
    Mesh mesh() {
        if (mass_of(mesh_.vertices, mesh_.triangles).volume < 0)
            for (auto& t : mesh_.triangles) std::swap(t[1], t[2]);
        return std::move(mesh_);
    }

private:
    Mesh mesh_;
};

} // namespace raycontact::scenes
