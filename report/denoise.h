// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/vector.h>

#include <cstdint>
#include <vector>

namespace raycontact::report {

/// A picture taken apart, row by row from the top left, linear: albedo x light + extra is what is seen.
struct Layers {
    std::uint32_t width = 0, height = 0;
    std::vector<Float3> albedo, light, extra;
    std::vector<Float3> normal, position; ///< mean over the pixel's samples; zero normal where nothing was hit
};

/// Smooths the light, and nothing else, where neighbours lie in one plane (edge-avoiding a-trous wavelet, Dammertz et
/// al. 2010): a few ambient rays a pixel then do. `pixel` is a pixel's width at distance 1, `eye` where distance counts
/// from.
void smooth_light(Layers& layers, Float3 eye, float pixel);

} // namespace raycontact::report
