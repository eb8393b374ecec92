// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fuzz/input.h"

#include <recording/block.h>
#include <recording/bytes.h>

#include <array>
#include <cstdint>

// The inputs of the recording's fuzzer. The first byte tells: 0, a whole file follows; else blocks follow, each a type,
// first step, number of steps, length (as below, little-endian) and its payload, not packed. Checksums are made anew,
// or no input but a sound one would come further than to them.
namespace raycontact::fuzz {

inline constexpr std::array block_types{recording::BlockType::info, recording::BlockType::shape,
                                        recording::BlockType::bodies, recording::BlockType::steps,
                                        recording::BlockType::end};

struct BlockInput {
    std::uint8_t type = 0; ///< index into block_types
    std::uint32_t first_step = 0, step_count = 0;
    std::uint16_t size = 0;
};

/// The file that an input stands for.
recording::Bytes recording_file(Bytes input);

} // namespace raycontact::fuzz
