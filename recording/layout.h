// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/block.h>
#include <recording/bytes.h>
#include <recording/recording.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::recording {

// The side chunk of the .glb file; docs/recording.md describes it byte by byte.

constexpr std::uint32_t side_chunk = four_letters("RAYC");
constexpr std::uint32_t format_version = 1;
/// The first bytes of the side chunk: a name, then the version as a word, then a word 0. Blocks follow.
constexpr std::array<unsigned char, 16> side_chunk_start{'r', 'a', 'y', 'c', 'r', 'e', 'c', 0, format_version,
                                                         0,   0,   0,   0,   0,   0,   0};

/// A body that comes or goes.
struct BodyEvent {
    enum Kind : std::uint32_t { comes = 0, goes = 1 };
    std::uint32_t step = 0; ///< the first step it takes part in, or takes no part in any more
    Kind kind = comes;
    std::uint32_t body = 0;
    std::uint32_t shape = 0;
};

Bytes encode_events(std::span<const BodyEvent> events);
/// Enters the events into `bodies`; throws Damage for what cannot have happened.
void apply_events(std::span<const unsigned char> payload, std::size_t shapes, std::vector<Body>& bodies);

/// A recording that is whole but made with a setting that a later version has.
class UnknownSetting : public Damage {
public:
    using Damage::Damage;
};

Bytes encode_info(const Info& info);
/// Settings that older recordings lack have their defaults. Throws Damage or UnknownSetting.
Info decode_info(std::span<const unsigned char> payload);

Bytes encode_end(std::uint32_t steps, std::string_view hash);
std::string decode_end(std::span<const unsigned char> payload, std::uint32_t steps); ///< the hash; throws Damage
bool is_hash(std::string_view text);                                                 ///< 16 lower-case hex digits

} // namespace raycontact::recording
