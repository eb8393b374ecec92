// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace raycontact::cuda {

/// Where NVRTC may be: paths, and names for the loader.
struct NvrtcPlaces {
    std::vector<std::string> given, others; ///< of RAYCONTACT_NVRTC; all others
};
NvrtcPlaces nvrtc_places();

} // namespace raycontact::cuda
