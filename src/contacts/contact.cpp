// SPDX-License-Identifier: Apache-2.0
#include <raycontact/contact.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <new>
#include <xxhash.h>

namespace raycontact {

namespace {

std::string key_of(VertexBody body, std::uint32_t vertex) {
    char text[11];
    std::snprintf(text, sizeof text, "%c0%08x", body == VertexBody::a ? 'a' : 'b', vertex);
    return text;
}

} // namespace

std::string contact_key(const Contact& contact) {
    return key_of(contact.vertex_body, contact.vertex);
}
std::string contact_key(const LostContact& contact) {
    return key_of(contact.vertex_body, contact.vertex);
}

ContactHash::ContactHash() : state_(XXH64_createState()) {
    if (state_ == nullptr) throw std::bad_alloc();
    XXH64_reset(static_cast<XXH64_state_t*>(state_), 0);
}

ContactHash::~ContactHash() {
    XXH64_freeState(static_cast<XXH64_state_t*>(state_));
}

void ContactHash::add(std::uint32_t step, std::span<const Contact> contacts) {
    unsigned char bytes[6 * 4 + 5 * 4 + 3 * 8];
    const auto put = [](unsigned char* to, auto bits) { // little-endian on every machine
        for (std::size_t i = 0; i < sizeof bits; ++i) to[i] = static_cast<unsigned char>(bits >> (8 * i));
    };
    for (const Contact& c : contacts) {
        const std::uint32_t words[] = {step,
                                       c.body_a,
                                       c.body_b,
                                       static_cast<std::uint32_t>(c.vertex_body),
                                       c.vertex,
                                       c.triangle,
                                       std::bit_cast<std::uint32_t>(c.normal[0]),
                                       std::bit_cast<std::uint32_t>(c.normal[1]),
                                       std::bit_cast<std::uint32_t>(c.normal[2]),
                                       std::bit_cast<std::uint32_t>(c.depth),
                                       std::bit_cast<std::uint32_t>(c.ray_length)};
        const std::uint64_t point[] = {std::bit_cast<std::uint64_t>(c.point.x), std::bit_cast<std::uint64_t>(c.point.y),
                                       std::bit_cast<std::uint64_t>(c.point.z)};
        for (std::size_t i = 0; i < 11; ++i) put(bytes + 4 * i, words[i]);
        for (std::size_t i = 0; i < 3; ++i) put(bytes + 44 + 8 * i, point[i]);
        XXH64_update(static_cast<XXH64_state_t*>(state_), bytes, sizeof bytes);
    }
}

std::string ContactHash::hex() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx",
                  static_cast<unsigned long long>(XXH64_digest(static_cast<const XXH64_state_t*>(state_))));
    return text;
}

} // namespace raycontact
