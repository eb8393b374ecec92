// SPDX-License-Identifier: Apache-2.0
#include "mesh/patches.h"

#include "interruption.h"

#include <map>

namespace raycontact {

Patches find_patches(std::span<const Triangle> triangles, std::span<const HalfEdge> edges) {
    std::vector<const HalfEdge*> across(3 * triangles.size(), nullptr); // the other side, where there is just one
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() != 2 || sides[0].triangle() == sides[1].triangle()) return;
        across[sides[0].corner] = &sides[1];
        across[sides[1].corner] = &sides[0];
    });

    constexpr std::uint32_t none = 0xffffffffu;
    Patches patches;
    patches.of.assign(triangles.size(), none);
    patches.against.assign(triangles.size(), 0);
    std::vector<std::uint32_t> open;
    const InterruptionCheck check;
    for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
        if (patches.of[seed] != none) continue;
        const auto id = static_cast<std::uint32_t>(patches.list.size());
        Patch patch{seed};
        patches.of[seed] = id;
        open.assign(1, seed);
        while (!open.empty()) {
            check();
            const std::uint32_t t = open.back();
            open.pop_back();
            ++patch.size;
            patch.turned += patches.against[t] ? 1 : 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const HalfEdge* const other = across[3 * std::size_t{t} + k];
                if (other == nullptr) continue;
                const bool forward = triangles[t][k] < triangles[t][(k + 1) % 3];
                const std::uint32_t next = other->triangle();
                const bool against = (patches.against[t] != 0) != (forward == other->forward);
                if (patches.of[next] == none) {
                    patches.of[next] = id;
                    patches.against[next] = against ? 1 : 0;
                    open.push_back(next);
                } else if ((patches.against[next] != 0) != against) {
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
