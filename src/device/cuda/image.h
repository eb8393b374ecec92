// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/nvrtc.h"

namespace raycontact::cuda {

/// The text that is compiled, and the options.
struct Source {
    std::string text;
    std::vector<std::string> options;
};

/// The kernels, with the options that give our bits.
Source exact_source();

/// What a driver loads on a device of an architecture (90 for a compute capability of 9.0): a cubin, or a PTX text for
/// the driver to compile, where the compiler does not know the device or the driver is of an older CUDA than the
/// compiler. From the cache, if it was compiled before.
std::string image_for(const Nvrtc& nvrtc, const Source& source, int architecture, int driver_major);

} // namespace raycontact::cuda
