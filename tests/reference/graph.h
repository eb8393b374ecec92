// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace raycontact::reference {

/// Marks connected nodes, one flood after the other.
class Graph {
public:
    std::uint32_t add() {
        near_.emplace_back();
        return static_cast<std::uint32_t>(near_.size() - 1);
    }
    void join(std::uint32_t x, std::uint32_t y) {
        near_[x].push_back(y);
        near_[y].push_back(x);
    }
    std::vector<std::uint32_t> flood() const {
        std::vector<std::uint32_t> region(near_.size(), unmarked);
        for (std::uint32_t first = 0; first < near_.size(); ++first) {
            if (region[first] != unmarked) continue;
            std::vector<std::uint32_t> open{first};
            region[first] = first;
            while (!open.empty()) {
                const std::uint32_t node = open.back();
                open.pop_back();
                for (const std::uint32_t next : near_[node])
                    if (region[next] == unmarked) {
                        region[next] = first;
                        open.push_back(next);
                    }
            }
        }
        return region;
    }

private:
    std::vector<std::vector<std::uint32_t>> near_;
    static constexpr std::uint32_t unmarked = 0xffffffffu;
};

} // namespace raycontact::reference
