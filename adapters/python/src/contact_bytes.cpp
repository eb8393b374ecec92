// SPDX-License-Identifier: Apache-2.0
#include "contact_bytes.h"

#include <cstddef>
#include <utility>

namespace raycontact::python {

ReadOnlyArray bytes_of(std::shared_ptr<const std::vector<Contact>> contacts) {
    using Held = std::shared_ptr<const std::vector<Contact>>;
    const auto* first = reinterpret_cast<const std::uint8_t*>(contacts->data());
    const std::size_t size = contacts->size() * sizeof(Contact);
    auto held = std::make_unique<Held>(std::move(contacts));
    const nb::capsule owner(held.release(), [](void* given) noexcept { delete static_cast<Held*>(given); });
    return ReadOnlyArray(first, {size}, owner, {}, nb::dtype<std::uint8_t>());
}

nb::list contact_layout() {
    nb::list fields;
    const auto field = [&](const char* name, const char* type, int length, std::size_t offset) {
        fields.append(nb::make_tuple(name, type, length, offset));
    };
    constexpr std::size_t feature = offsetof(Contact, feature);
    static_assert(sizeof(BodyId) == 8 && offsetof(Contact, body_b) == offsetof(Contact, body_a) + 8);
    static_assert(offsetof(ContactFeature, index_b) == offsetof(ContactFeature, index_a) + 4);
    field("bodies", "<i8", 2, offsetof(Contact, body_a));
    field("kind", "u1", 0, feature + offsetof(ContactFeature, kind));
    field("source", "u1", 0, feature + offsetof(ContactFeature, source));
    field("indices", "<u4", 2, feature + offsetof(ContactFeature, index_a));
    field("is_new", "?", 0, offsetof(Contact, is_new));
    field("normal", "<f4", 3, offsetof(Contact, normal));
    field("depth", "<f4", 0, offsetof(Contact, depth));
    field("ray_length", "<f4", 0, offsetof(Contact, ray_length));
    field("weight", "<f4", 0, offsetof(Contact, weight));
    field("point_a", "<f8", 3, offsetof(Contact, point_a));
    field("point_b", "<f8", 3, offsetof(Contact, point_b));
    return fields;
}

} // namespace raycontact::python
