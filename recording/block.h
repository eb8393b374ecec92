// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/bytes.h>

#include <cstdint>
#include <span>

namespace raycontact::recording {

/// Four letters, read as a little-endian word: they can be seen in a dump.
constexpr std::uint32_t four_letters(const char (&text)[5]) {
    std::uint32_t word = 0;
    for (int i = 3; i >= 0; --i) word = word << 8 | static_cast<unsigned char>(text[i]);
    return word;
}

enum class BlockType : std::uint32_t {
    info = four_letters("INFO"),   ///< Info as JSON; the first block
    shape = four_letters("SHAP"),  ///< a mesh, or measures of a round shape; shapes count from 0 in their blocks' order
    bodies = four_letters("BODY"), ///< bodies that come and go, before the steps they concern
    steps = four_letters("STEP"),  ///< poses and pairs of consecutive steps; decodable on its own
    end = four_letters("END "),    ///< the run's hash as JSON; the last block
};

/// The first bytes of each block. The payload follows, zlib-compressed, padded with zeros to 8 bytes.
struct BlockHeader {
    static constexpr std::size_t size = 40;
    BlockType type{};
    std::uint64_t stored = 0;                     ///< bytes of the payload as it lies in the file, without padding
    std::uint64_t raw = 0;                        ///< bytes of the payload once unpacked
    std::uint32_t first_step = 0, step_count = 0; ///< of a steps block, else 0
    /// XXH64 of the header before this field and the padded payload; seed: the block's place.
    std::uint64_t checksum = 0;

    std::uint64_t padded() const { return (stored + 7) & ~std::uint64_t{7}; }
};

/// How hard to try: steps are written while a simulation waits.
enum class Effort { none, quick, thorough };

/// The longest payload of a block that is JSON.
constexpr std::uint64_t most_text = std::uint64_t{1} << 20;

/// A whole block, header to padding. `place` is its distance from the start of the side chunk's data.
Bytes make_block(BlockType type, std::uint32_t first_step, std::uint32_t step_count, std::span<const unsigned char> raw,
                 std::uint64_t place, Effort effort);

/// From BlockHeader::size bytes; throws Damage for a type or coding that this version does not know.
BlockHeader read_block_header(std::span<const unsigned char> bytes);

/// The payload unpacked. `stored` is what follows the header, padding included. Throws Damage unless the checksum and
/// both lengths are right.
Bytes unpack_block(const BlockHeader& header, std::span<const unsigned char> stored, std::uint64_t place);

/// Whether the checksum is that of these bytes.
bool block_is_intact(const BlockHeader& header, std::span<const unsigned char> stored, std::uint64_t place);

} // namespace raycontact::recording
