// SPDX-License-Identifier: Apache-2.0
#include <scenes/depth_watch.h>

#include <algorithm>
#include <utility>

namespace raycontact::scenes {

void DepthWatch::add(std::uint32_t step, std::span<const Contact> contacts) {
    std::vector<Run> now;
    for (const Contact& c : contacts) {
        if (static_cast<double>(c.depth) <= limit_) continue;
        now.push_back({{c.body_a, c.body_b, c.key()}, 1});
    }
    contacts_ += now.size();
    std::sort(now.begin(), now.end(), [](const Run& a, const Run& b) { return a.key < b.key; });
    auto old = runs_.begin();
    by_step_.resize(step + 1u, 0);
    for (Run& run : now) {
        while (old != runs_.end() && old->key < run.key) ++old;
        if (old != runs_.end() && old->key == run.key) run.steps = old->steps + 1;
        longest_ = std::max(longest_, run.steps);
        by_step_[step] = std::max(by_step_[step], run.steps);
    }
    runs_ = std::move(now);
}

std::uint32_t DepthWatch::longest_since(std::uint32_t step) const {
    std::uint32_t most = 0;
    for (std::size_t i = step; i < by_step_.size(); ++i) most = std::max(most, by_step_[i]);
    return most;
}

} // namespace raycontact::scenes
