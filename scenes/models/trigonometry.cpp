// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/trigonometry.h>

#include <cmath>

namespace raycontact::scenes {

SineCosine sine_cosine(double turns) {
    // To the nearest quarter turn: |x| <= pi / 4, where the Taylor series below are good to the last bit or so.
    const double quarters = std::floor(4 * turns + 0.5);
    const double x = (4 * turns - quarters) * 1.5707963267948966;
    const double y = x * x;
    double s = -1.0 / 1307674368000;
    s = s * y + 1.0 / 6227020800;
    s = s * y - 1.0 / 39916800;
    s = s * y + 1.0 / 362880;
    s = s * y - 1.0 / 5040;
    s = s * y + 1.0 / 120;
    s = s * y - 1.0 / 6;
    s = s * y * x + x;
    double c = 1.0 / 20922789888000;
    c = c * y - 1.0 / 87178291200;
    c = c * y + 1.0 / 479001600;
    c = c * y - 1.0 / 3628800;
    c = c * y + 1.0 / 40320;
    c = c * y - 1.0 / 720;
    c = c * y + 1.0 / 24;
    c = c * y - 0.5;
    c = c * y + 1;
    switch (static_cast<int>(quarters - 4 * std::floor(quarters / 4))) {
    case 0:
        return {s, c};
    case 1:
        return {c, -s};
    case 2:
        return {-s, -c};
    default:
        return {-c, s};
    }
}

} // namespace raycontact::scenes
