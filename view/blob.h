// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/bytes.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>

namespace raycontact::view {

using Bytes = recording::Bytes;

/// A part of 1 in 16 bits.
inline std::uint16_t quantised(double part) {
    return static_cast<std::uint16_t>(std::lround(65535 * std::clamp(part, 0.0, 1.0)));
}

/// Of numbers of 16 bits: first every lower byte, then every upper one. Neighbours that are alike then lie together.
Bytes split_bytes(std::span<const std::uint16_t> numbers);

std::string base64(std::span<const unsigned char> bytes);

/// zlib-compressed, in base64: what the page unpacks with DecompressionStream("deflate").
std::string blob(std::span<const unsigned char> bytes);

} // namespace raycontact::view
