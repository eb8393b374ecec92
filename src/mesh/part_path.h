// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raycontact {

/// AssemblyPart::under of a part whose ancestors are told the nearest first. Long ones are cut off: else a deep tree
/// would take the square of its size.
class Ancestors {
public:
    /// false: no more is taken.
    bool add(std::string name) {
        constexpr std::size_t most = 1024;
        bytes_ += name.size() + 1;
        if (bytes_ > most) return false;
        names_.push_back(std::move(name));
        return true;
    }
    std::vector<std::string> from_root() && {
        std::ranges::reverse(names_);
        return std::move(names_);
    }

private:
    std::vector<std::string> names_;
    std::size_t bytes_ = 0;
};

/// With "/" between.
std::string joined(std::span<const std::string> names);

} // namespace raycontact
