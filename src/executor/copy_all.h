// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <algorithm>
#include <span>
#include <vector>

namespace raycontact {

/// to = from, on all threads.
template <class T>
void copy_all(Executor& executor, std::span<const T> from, std::vector<T>& to) {
    to.resize(from.size());
    executor.run(static_cast<std::uint32_t>(from.size()), 8192, [&](std::uint32_t begin, std::uint32_t end) {
        std::copy(from.begin() + begin, from.begin() + end, to.begin() + begin);
    });
}

} // namespace raycontact
