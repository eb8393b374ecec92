// SPDX-License-Identifier: Apache-2.0
#include "mesh/patches.h"

#include <algorithm>
#include <array>
#include <map>

namespace raycontact {
namespace {

struct Across {
    std::uint32_t triangle = 0xffffffffu;
    bool against = false; ///< the two triangles run along their edge in the same direction
};

} // namespace

Patches find_patches(std::span<const Triangle> triangles, std::span<const HalfEdge> edges) {
    std::vector<std::array<Across, 3>> across(triangles.size());
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() != 2 || sides[0].triangle() == sides[1].triangle()) return;
        const bool against = sides[0].forward == sides[1].forward;
        across[sides[0].triangle()][sides[0].corner % 3] = {sides[1].triangle(), against};
        across[sides[1].triangle()][sides[1].corner % 3] = {sides[0].triangle(), against};
    });

    constexpr std::uint32_t none = 0xffffffffu;
    Patches patches;
    patches.of.assign(triangles.size(), none);
    patches.against.assign(triangles.size(), 0);
    std::vector<std::uint32_t> open;
    for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
        if (patches.of[seed] != none) continue;
        const auto id = static_cast<std::uint32_t>(patches.list.size());
        Patch patch{seed};
        patches.of[seed] = id;
        open.assign(1, seed);
        while (!open.empty()) {
            const std::uint32_t t = open.back();
            open.pop_back();
            ++patch.size;
            patch.turned += patches.against[t] ? 1 : 0;
            for (const Across& next : across[t]) {
                if (next.triangle == none) continue;
                const bool against = (patches.against[t] != 0) != next.against;
                if (patches.of[next.triangle] == none) {
                    patches.of[next.triangle] = id;
                    patches.against[next.triangle] = against ? 1 : 0;
                    open.push_back(next.triangle);
                } else if ((patches.against[next.triangle] != 0) != against) {
                    patch.orientable = false;
                }
            }
        }
        patches.list.push_back(patch);
    }

    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() == 2 && sides[0].triangle() != sides[1].triangle()) return; // balanced once windings agree
        std::map<std::uint32_t, int> balance;
        for (const HalfEdge& side : sides) {
            const bool forward = side.forward != (patches.against[side.triangle()] != 0);
            balance[patches.of[side.triangle()]] += forward ? 1 : -1;
        }
        for (const auto& [id, sum] : balance) {
            if (sum != 0) patches.list[id].closed = false;
        }
    });
    for (Patch& patch : patches.list) patch.closed = patch.closed && patch.orientable;
    return patches;
}

} // namespace raycontact
