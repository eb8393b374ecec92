// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace raycontact {

/// Sorts the contacts of one direction of a pair by vertex. keys: the vertex in the upper word, no two alike; the lower
/// word moves along and does not affect the order.
void sort_by_vertex(std::span<std::uint64_t> keys);

} // namespace raycontact
