// SPDX-License-Identifier: Apache-2.0
#include <raycontact/contact.h>

#include <bit>
#include <cstdio>
#include <new>
#include <xxhash.h>

namespace raycontact {

// A step writes and reads some ten thousand of them: the small members fill what the alignment of `point` leaves free.
static_assert(sizeof(Contact) <= 72);

namespace {

Vec3 moved(const Contact& contact, double sign) {
    const double by = sign * double(contact.depth);
    return {contact.point.x + by * double(contact.normal[0]), contact.point.y + by * double(contact.normal[1]),
            contact.point.z + by * double(contact.normal[2])};
}

} // namespace

Vec3 point_on_a(const Contact& contact) {
    return contact.vertex_body == VertexBody::a ? contact.point : moved(contact, 1);
}

Vec3 point_on_b(const Contact& contact) {
    return contact.vertex_body == VertexBody::b ? contact.point : moved(contact, -1);
}

std::string contact_key(const Contact& contact) {
    return contact_key(LostContact{contact.body_a, contact.body_b, contact.vertex_body, contact.feature, contact.vertex,
                                   contact.other()});
}

std::string contact_key(const LostContact& contact) {
    char text[19];
    const int length = std::snprintf(text, sizeof text, "%c%u%08x", contact.vertex_body == VertexBody::a ? 'a' : 'b',
                                     static_cast<unsigned>(contact.feature), contact.vertex);
    if (contact.feature == Feature::edges)
        std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length), "%08x", contact.other);
    return text;
}

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
        if (is_speculative(c) && !speculative_) continue;
        unsigned char bytes[6 * 4 + 6 * 4 + 3 * 8];
        unsigned char* to = bytes;
        const auto put = [&to](auto bits) { // little-endian on every machine
            for (std::size_t i = 0; i < sizeof bits; ++i) *to++ = static_cast<unsigned char>(bits >> (8 * i));
        };
        const std::uint32_t source = std::uint32_t(c.vertex_body) + 2 * std::uint32_t(c.feature);
        for (const auto word : {step, c.body_a, c.body_b, source, c.vertex, c.triangle}) put(word);
        for (const float x : {c.normal[0], c.normal[1], c.normal[2], c.depth, c.ray_length})
            put(std::bit_cast<std::uint32_t>(x));
        if (weighted_) put(std::bit_cast<std::uint32_t>(c.weight));
        for (const double x : {c.point.x, c.point.y, c.point.z}) put(std::bit_cast<std::uint64_t>(x));
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
