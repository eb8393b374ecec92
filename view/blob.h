// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::view {

using Bytes = std::vector<unsigned char>;

/// Whole numbers as the page reads them: least byte first.
void put16(Bytes& to, std::uint32_t value);
void put32(Bytes& to, std::uint32_t value);

/// Of numbers of 16 bits: first every lower byte, then every upper one. Neighbours that are alike then lie together.
Bytes split_bytes(std::span<const std::uint16_t> numbers);

/// zlib-compressed, in base64: what the page unpacks with DecompressionStream("deflate").
std::string blob(std::span<const unsigned char> bytes);

} // namespace raycontact::view
