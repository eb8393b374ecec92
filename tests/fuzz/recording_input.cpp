// SPDX-License-Identifier: Apache-2.0
#include "fuzz/recording_input.h"

#include <recording/layout.h>
#include <recording/viewer_part.h>

#include <xxhash.h>

#include <algorithm>
#include <cstring>

namespace raycontact::fuzz {

namespace {

constexpr std::size_t checksum_at = recording::BlockHeader::size - 8;

recording::Bytes blocks_in_a_file(Bytes input) {
    recording::Bytes side(recording::side_chunk_start.begin(), recording::side_chunk_start.end());
    for (Source source(input); !source.empty();) {
        BlockInput block;
        block.type = source.get<std::uint8_t>();
        block.first_step = source.get<std::uint32_t>();
        block.step_count = source.get<std::uint32_t>();
        block.size = source.get<std::uint16_t>();
        const recording::Bytes made =
            recording::make_block(block_types[block.type % block_types.size()], block.first_step, block.step_count,
                                  source.take(block.size), side.size(), recording::Effort::quick);
        side.insert(side.end(), made.begin(), made.end());
    }
    recording::Bytes file = recording::viewer_part({}, {}, {}, {});
    recording::put(file, static_cast<std::uint32_t>(side.size()));
    recording::put(file, recording::side_chunk);
    file.insert(file.end(), side.begin(), side.end());
    const auto length = static_cast<std::uint32_t>(file.size());
    std::memcpy(file.data() + recording::glb::length_at, &length, sizeof length);
    return file;
}

recording::Bytes mended(Bytes input) {
    recording::Bytes file(input.begin(), input.end());
    const auto start = recording::side_chunk_start;
    const auto found = std::search(file.begin(), file.end(), start.begin(), start.begin() + 8);
    if (found == file.end()) return file;
    const auto data = static_cast<std::size_t>(found - file.begin());
    for (std::size_t at = data + start.size(); at + recording::BlockHeader::size <= file.size();) {
        std::uint64_t stored = 0;
        std::memcpy(&stored, file.data() + at + 8, sizeof stored);
        if (stored > file.size()) break;
        const auto padded = static_cast<std::size_t>((stored + 7) & ~std::uint64_t{7});
        const std::size_t end = at + recording::BlockHeader::size + padded;
        if (end > file.size()) break;
        recording::Bytes summed(file.begin() + at, file.begin() + at + checksum_at);
        summed.insert(summed.end(), file.begin() + at + recording::BlockHeader::size, file.begin() + end);
        const std::uint64_t sum = XXH64(summed.data(), summed.size(), at - data);
        std::memcpy(file.data() + at + checksum_at, &sum, sizeof sum);
        at = end;
    }
    return file;
}

} // namespace

recording::Bytes recording_file(Bytes input) {
    if (input.empty()) return {};
    return input[0] == 0 ? mended(input.subspan(1)) : blocks_in_a_file(input.subspan(1));
}

} // namespace raycontact::fuzz
