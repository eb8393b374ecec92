// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace raycontact {

/// A cell of a grid, or a step between two.
using Cell = std::array<int, 3>;

/// A grid of cubic cells.
struct Cells {
    Cell size{};

    int count() const { return size[0] * size[1] * size[2]; }
    int index(const Cell& c) const { return (c[2] * size[1] + c[1]) * size[0] + c[0]; }
    Cell at(int index) const { return {index % size[0], index / size[0] % size[1], index / size[0] / size[1]}; }
    bool has(const Cell& c) const {
        const auto within = [&](int k) { return static_cast<unsigned>(c[k]) < static_cast<unsigned>(size[k]); };
        return within(0) && within(1) && within(2);
    }

    /// Floods the grid from outside, from cell to cell. enters(i, from) tells whether the way from cell `from` (-1:
    /// outside the grid) into cell i is open and cell i was not entered before.
    template <class Enters>
    void flood(Enters&& enters) const {
        std::vector<int> open;
        for (int i = 0; i < count(); ++i) {
            const auto [x, y, z] = at(i);
            const bool at_face = x == 0 || y == 0 || z == 0 || x == size[0] - 1 || y == size[1] - 1 || z == size[2] - 1;
            if (at_face && enters(i, -1)) open.push_back(i);
        }
        while (!open.empty()) {
            const int from = open.back();
            const Cell cell = at(from);
            open.pop_back();
            for (int side = 0; side < 6; ++side) {
                Cell next = cell;
                next[side / 2] += side % 2 == 0 ? -1 : 1;
                if (has(next) && enters(index(next), from)) open.push_back(index(next));
            }
        }
    }
};

} // namespace raycontact
