// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/vector.h>

#include <cstddef>
#include <cstdint>

namespace raycontact::report {

/// Linear colour from an sRGB one as 0xrrggbb.
Float3 linear(std::uint32_t srgb);

/// A pleasant colour for a body, from its index alone: the same body has the same colour in every picture.
Float3 body_colour(std::size_t body);

/// Of a body that stands still.
Float3 resting_colour();

/// What the sky sends from a unit direction, z up.
Float3 sky(Float3 direction);

/// Linear light to 8-bit sRGB through a filmic curve.
void develop(Float3 light, std::uint8_t* rgb);

} // namespace raycontact::report
