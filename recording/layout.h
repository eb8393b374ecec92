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

// The side chunk of the .glb file; docs/internals/recording.md describes it byte by byte.

constexpr std::uint32_t side_chunk = four_letters("RAYC");
/// In version 1 ids were never given twice; since then slots are, by the rule of Scene::add.
constexpr std::uint32_t format_version = 2, oldest_version = 1;
/// The first bytes of the side chunk: a name, then the version as a word, then a word 0. Blocks follow.
constexpr std::array<unsigned char, 16> side_chunk_start{'r', 'a', 'y', 'c', 'r', 'e', 'c', 0, format_version,
                                                         0,   0,   0,   0,   0,   0,   0};

Bytes encode_events(std::span<const BodyEvent> events);
/// Adds to the events, and enters them into `bodies`; throws Damage for what cannot have happened.
void apply_events(std::span<const unsigned char> payload, std::size_t shapes, std::vector<BodyEvent>& events,
                  std::vector<Body>& bodies);
/// Gives the bodies the ids that a scene gives them when the events happen to it, in their order.
void give_ids(std::uint32_t version, std::span<const BodyEvent> events, std::vector<Body>& bodies);

/// A recording that is whole but made with a setting that a later version has.
class UnknownSetting : public Damage {
public:
    using Damage::Damage;
};

Bytes encode_info(const Info& info);
/// Settings that older recordings lack have their defaults. Throws Damage, also for another version, or UnknownSetting.
Info decode_info(std::span<const unsigned char> payload, std::uint32_t version);

Bytes encode_end(std::uint32_t steps, std::string_view hash);
std::string decode_end(std::span<const unsigned char> payload, std::uint32_t steps); ///< the hash; throws Damage
bool is_hash(std::string_view text);                                                 ///< 16 lower-case hex digits

} // namespace raycontact::recording
