// SPDX-License-Identifier: Apache-2.0
#include <raycontact/contact.h>

#include <bit>
#include <cstdio>
#include <new>
#include <xxhash.h>

namespace raycontact {

// A step writes and reads some ten thousand of them.
static_assert(sizeof(Contact) <= 104);

ContactHash::ContactHash(Direction direction, bool speculative)
    : state_(XXH64_createState()), weighted_(direction == Direction::weighted), speculative_(speculative) {
    if (state_ == nullptr) throw std::bad_alloc();
    XXH64_reset(static_cast<XXH64_state_t*>(state_), 0);
}

ContactHash::~ContactHash() {
    XXH64_freeState(static_cast<XXH64_state_t*>(state_));
}

void ContactHash::add(std::uint32_t step, std::span<const Contact> contacts) {
    for (const Contact& c : contacts) {
        if (c.is_speculative() && !speculative_) continue;
        unsigned char bytes[6 * 4 + 6 * 4 + 3 * 8];
        unsigned char* to = bytes;
        const auto put = [&to](auto bits) { // little-endian on every machine
            for (std::size_t i = 0; i < sizeof bits; ++i) *to++ = static_cast<unsigned char>(bits >> (8 * i));
        };
        const ContactFeature& f = c.feature;
        const std::uint32_t what = std::uint32_t(f.source) + 2 * std::uint32_t(f.kind);
        for (const auto word : {step, c.body_a.slot, c.body_b.slot, what, f.source_index(), f.other_index()}) put(word);
        for (const float x : {c.normal.x, c.normal.y, c.normal.z, c.depth, c.ray_length})
            put(std::bit_cast<std::uint32_t>(x));
        if (weighted_) put(std::bit_cast<std::uint32_t>(c.weight));
        for (const double x : {c.point().x, c.point().y, c.point().z}) put(std::bit_cast<std::uint64_t>(x));
        XXH64_update(static_cast<XXH64_state_t*>(state_), bytes, static_cast<std::size_t>(to - bytes));
    }
}

std::string ContactHash::hex() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx",
                  static_cast<unsigned long long>(XXH64_digest(static_cast<const XXH64_state_t*>(state_))));
    return text;
}

} // namespace raycontact
