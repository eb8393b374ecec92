// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

namespace raycontact::clash {

/// Which pairs are asked about, and what room they should have: ClashOptions::against, exclude, exclude_parent_child,
/// clearance and clearances.
class Selection {
public:
    /// Throws InputError as find_clashes(). word: what messages call ClashOptions::against.
    Selection(std::span<const AssemblyPart> parts, const ClashOptions& options, const char* word = "against");
    bool has(std::size_t a, std::size_t b) const;
    /// Metres.
    double clearance(std::size_t a, std::size_t b) const;
    double largest_clearance() const; ///< of any pair
    /// Whether ClashOptions::against, which there is, matches a part.
    bool is_against(std::size_t part) const { return against_[part] != 0; }

private:
    std::span<const AssemblyPart> parts_;
    bool parent_child_;
    std::vector<char> against_; ///< by part, whether a pattern matches it; empty: all against all
    /// Of each part the pairs of patterns of which it matches the first, and the second; rising.
    using Matched = std::array<std::vector<std::vector<std::uint32_t>>, 2>;
    Matched excluded_, cleared_;          ///< of `exclude`, and of `clearances`; empty: there are none
    double clearance_;                    ///< of all others
    std::vector<ClearanceOf> clearances_; ///< the largest first
};

} // namespace raycontact::clash
