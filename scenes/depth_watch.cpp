// SPDX-License-Identifier: Apache-2.0
#include <scenes/depth_watch.h>

#include <algorithm>
#include <utility>

namespace raycontact::scenes {

void DepthWatch::add(std::uint32_t step, std::span<const Contact> contacts) {
    std::map<Key, std::uint32_t> now;
    by_step_.resize(step + 1u, 0);
    for (const Contact& c : contacts) {
        if (static_cast<double>(c.depth) <= limit_) continue;
        const Key key{c.body_a, c.body_b, c.key()};
        const auto before = runs_.find(key);
        const std::uint32_t steps = before == runs_.end() ? 1 : before->second + 1;
        now.emplace(key, steps);
        by_step_[step] = std::max(by_step_[step], steps);
        ++contacts_;
    }
    runs_ = std::move(now);
}

std::uint32_t DepthWatch::longest_since(std::uint32_t step) const {
    std::uint32_t most = 0;
    for (std::size_t i = step; i < by_step_.size(); ++i) most = std::max(most, by_step_[i]);
    return most;
}

} // namespace raycontact::scenes
