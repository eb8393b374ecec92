// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

#include <vector>

namespace raycontact::bench {

/// What an array holds, for the host.
template <typename T>
std::vector<T> copy_of(Device& device, const Array<T>& array) {
    std::vector<T> host(array.size());
    array.read(device, host);
    return host;
}

} // namespace raycontact::bench
