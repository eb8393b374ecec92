// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace raycontact::scenes {

struct SineCosine {
    double sine = 0, cosine = 1;
};

/// Sine and cosine of an angle given in whole turns. Plain + - * and floor only, so every compiler gives the same bits,
/// which libm does not promise. Absolute error below 1e-15 for |turns| < 1e6; exact at multiples of a quarter turn.
SineCosine sine_cosine(double turns);

} // namespace raycontact::scenes
