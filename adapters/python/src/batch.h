// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace raycontact::python {

/// Calls work(i) for each i below count, on several threads (0: one per core, 1024 at most), without the GIL. The
/// calling thread works too and looks for Ctrl-C. Throws what the lowest i of those that failed threw; an InputError
/// then says which item it was, if there are several. item: its noun, as "pair".
void for_each_item(std::size_t count, std::uint32_t threads, const std::string& item,
                   const std::function<void(std::size_t)>& work);

} // namespace raycontact::python
