// SPDX-License-Identifier: Apache-2.0
#include <report/denoise.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace raycontact::report {
namespace {

void pass(const Layers& layers, const std::vector<Float3>& from, std::vector<Float3>& to, int step, Float3 eye,
          float pixel) {
    constexpr float kernel[3] = {3.0f / 8, 1.0f / 4, 1.0f / 16};
    const int width = static_cast<int>(layers.width), height = static_cast<int>(layers.height);
    tbb::parallel_for(tbb::blocked_range<int>(0, height), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y)
            for (int x = 0; x < width; ++x) {
                const auto here = static_cast<std::size_t>(y) * layers.width + static_cast<std::size_t>(x);
                const Float3 n = layers.normal[here], p = layers.position[here];
                if (dot(n, n) == 0) {
                    to[here] = from[here];
                    continue;
                }
                const float footprint = pixel * length(p - eye);
                Float3 sum;
                float weight = 0;
                for (int j = -2; j <= 2; ++j)
                    for (int i = -2; i <= 2; ++i) {
                        const int qx = std::clamp(x + i * step, 0, width - 1),
                                  qy = std::clamp(y + j * step, 0, height - 1);
                        const auto there = static_cast<std::size_t>(qy) * layers.width + static_cast<std::size_t>(qx);
                        const Float3 m = layers.normal[there], q = layers.position[there];
                        const float alike = std::max(0.0f, dot(n, m));
                        // Off the plane by more than a few pixels' width: another surface.
                        const float off = dot(n, q - p) / (3 * footprint);
                        const float facing = alike * alike * alike * alike;
                        const float w = kernel[std::abs(i)] * kernel[std::abs(j)] * facing * facing * facing
                                        / (1 + off * off * off * off);
                        sum += w * from[there];
                        weight += w;
                    }
                to[here] = weight > 0 ? (1 / weight) * sum : from[here];
            }
    });
}

} // namespace

void smooth_light(Layers& layers, Float3 eye, float pixel) {
    std::vector<Float3> other(layers.light.size());
    pass(layers, layers.light, other, 1, eye, pixel);
    pass(layers, other, layers.light, 2, eye, pixel);
}

} // namespace raycontact::report
