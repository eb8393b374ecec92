// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/rings.h>

#include <cmath>
#include <numeric>

namespace raycontact::scenes {

std::vector<std::uint32_t> share_out(std::uint32_t total, const std::vector<double>& weights, std::uint32_t least) {
    const auto count = static_cast<std::uint32_t>(weights.size());
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<std::uint32_t> shares(count, least);
    const std::uint32_t spare = total - least * count;
    // Rounding the running sum, not each share, makes the total exact and the remainder even.
    double reached = 0;
    std::uint32_t given = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        reached += weights[k];
        const auto due = k + 1 == count ? spare : static_cast<std::uint32_t>(std::floor(spare * (reached / sum) + 0.5));
        shares[k] += due - given;
        given = due;
    }
    return shares;
}

void stitch(Mesh& mesh, const Ring& a, const Ring& b, std::uint32_t b_start) {
    const auto a_count = static_cast<std::uint32_t>(a.turn.size()), b_count = static_cast<std::uint32_t>(b.turn.size());
    const double shift = b_start == 0 ? 0 : a.turn[0] - b.turn[b_start];
    const auto a_turn = [&](std::uint32_t i) {
        const std::uint32_t rounds = i / a_count;
        return a.turn[i % a_count] + rounds;
    };
    const auto b_turn = [&](std::uint32_t j) {
        const std::uint32_t rounds = (b_start + j) / b_count;
        return b.turn[(b_start + j) % b_count] + rounds + shift;
    };
    const auto a_point = [&](std::uint32_t i) { return a.first + i % a_count; };
    const auto b_point = [&](std::uint32_t j) { return b.first + (b_start + j) % b_count; };
    for (std::uint32_t i = 0, j = 0; i < a_count || j < b_count;) {
        // The edge whose middle comes first: close to the shorter diagonal, and never across a corner both rings share.
        const bool advance_a = j == b_count || (i < a_count && a_turn(i) + a_turn(i + 1) <= b_turn(j) + b_turn(j + 1));
        if (advance_a) {
            mesh.triangles.push_back({a_point(i), a_point(i + 1), b_point(j)});
            ++i;
        } else {
            mesh.triangles.push_back({a_point(i), b_point(j + 1), b_point(j)});
            ++j;
        }
    }
}

std::uint32_t nearest_start(const Mesh& mesh, const Ring& a, const Ring& b) {
    const Vec3& p = mesh.vertices[a.first];
    std::uint32_t best = 0;
    double best_distance = -1;
    for (std::uint32_t j = 0; j < b.turn.size(); ++j) {
        const Vec3& v = mesh.vertices[b.first + j];
        const double distance = (v.x - p.x) * (v.x - p.x) + (v.y - p.y) * (v.y - p.y) + (v.z - p.z) * (v.z - p.z);
        if (best_distance < 0 || distance < best_distance) {
            best = j;
            best_distance = distance;
        }
    }
    return best;
}

} // namespace raycontact::scenes
