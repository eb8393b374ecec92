// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

namespace raycontact::clash {

/// Which pairs are asked about: ClashOptions::against, exclude and exclude_parent_child.
class Selection {
public:
    /// Throws InputError as find_clashes(). word: what messages call ClashOptions::against.
    Selection(std::span<const AssemblyPart> parts, const ClashOptions& options, const char* word = "against");
    bool has(std::size_t a, std::size_t b) const;
    /// Whether ClashOptions::against, which there is, matches a part.
    bool is_against(std::size_t part) const { return against_[part] != 0; }

private:
    std::span<const AssemblyPart> parts_;
    bool parent_child_;
    std::vector<char> against_; ///< by part, whether a pattern matches it; empty: all against all
    /// By part, the pairs of `exclude` of which it matches the first, and the second; rising.
    std::array<std::vector<std::vector<std::uint32_t>>, 2> excluded_;
};

} // namespace raycontact::clash
