// SPDX-License-Identifier: Apache-2.0
#include "contacts/column_writer.h"

#include <raycontact/error.h>

#include <array>
#include <cstring>
#include <exception>
#include <string>
#include <type_traits>

namespace raycontact {

namespace {

struct Word {
    ContactColumn column;
    std::string_view word;
    std::size_t bytes; ///< of a contact
};
constexpr Word words[] = {{ContactColumn::slots, "slots", 8},      {ContactColumn::bodies, "bodies", 16},
                          {ContactColumn::key, "key", 8},          {ContactColumn::kind, "kind", 1},
                          {ContactColumn::source, "source", 1},    {ContactColumn::indices, "indices", 8},
                          {ContactColumn::is_new, "is_new", 1},    {ContactColumn::point_a, "point_a", 24},
                          {ContactColumn::point_b, "point_b", 24}, {ContactColumn::normal, "normal", 12},
                          {ContactColumn::depth, "depth", 4},      {ContactColumn::ray_length, "ray_length", 4},
                          {ContactColumn::weight, "weight", 4}};

const Word& word_of(ContactColumn column) {
    for (const Word& one : words)
        if (one.column == column) return one;
    throw InputError("contact column " + std::to_string(int(column)) + " is none");
}

template <class Value>
void put(std::byte* to, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    std::memcpy(to, &value, sizeof value);
}

void put_point(std::byte* to, const Vec3& p, NumberType type) {
    if (type == NumberType::float64) return put(to, std::array{p.x, p.y, p.z});
    put(to, std::array{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
}

void put(std::byte* to, const Contact& contact, const ContactOutput& output) {
    using Numbers = std::array<std::uint32_t, 2>;
    switch (output.column) {
    case ContactColumn::slots:
        return put(to, Numbers{contact.body_a.slot, contact.body_b.slot});
    case ContactColumn::bodies:
        return put(to, std::array{contact.body_a.slot, contact.body_a.generation, contact.body_b.slot,
                                  contact.body_b.generation});
    case ContactColumn::key:
        return put(to, contact.key());
    case ContactColumn::kind:
        return put(to, static_cast<std::uint8_t>(contact.feature.kind));
    case ContactColumn::source:
        return put(to, static_cast<std::uint8_t>(contact.feature.source));
    case ContactColumn::indices:
        return put(to, Numbers{contact.feature.index_a, contact.feature.index_b});
    case ContactColumn::is_new:
        return put(to, static_cast<std::uint8_t>(contact.is_new));
    case ContactColumn::point_a:
        return put_point(to, contact.point_a, output.points);
    case ContactColumn::point_b:
        return put_point(to, contact.point_b, output.points);
    case ContactColumn::normal:
        return put(to, std::array{contact.normal.x, contact.normal.y, contact.normal.z});
    case ContactColumn::depth:
        return put(to, contact.depth);
    case ContactColumn::ray_length:
        return put(to, contact.ray_length);
    case ContactColumn::weight:
        return put(to, contact.weight);
    }
}

} // namespace

ContactColumn contact_column_from(std::string_view word) {
    std::string known;
    for (const Word& one : words) {
        if (one.word == word) return one.column;
        known += (known.empty() ? "" : ", ") + std::string(one.word);
    }
    throw InputError("contacts have no column \"" + std::string(word) + "\"; choose from " + known);
}

std::string_view to_string(ContactColumn column) {
    return word_of(column).word;
}

std::size_t bytes_of(ContactColumn column, NumberType points) {
    const bool is_point = column == ContactColumn::point_a || column == ContactColumn::point_b;
    return word_of(column).bytes / (is_point && points == NumberType::float32 ? 2 : 1);
}

void ContactColumnWriter::run(Executor& executor, std::span<const Contact> contacts,
                              std::span<const ContactOutput> outputs) {
    for (const ContactOutput& output : outputs)
        if (const std::size_t room = output.memory.bytes() / bytes_of(output.column, output.points);
            room < contacts.size())
            throw InputError("Scene::write_contacts: column " + std::string(to_string(output.column)) + " has room for "
                             + std::to_string(room) + " contacts, and there are " + std::to_string(contacts.size())
                             + "; make it larger, or ask for fewer (max_contacts)");
    columns_.resize(outputs.size());
    for (std::size_t k = 0; k < outputs.size(); ++k) {
        const std::size_t size = bytes_of(outputs[k].column, outputs[k].points);
        columns_[k].resize(size * contacts.size());
        executor.each(contacts.size(), 1024,
                      [&](std::uint32_t i) { put(columns_[k].data() + size * i, contacts[i], outputs[k]); });
    }
    // Begun together, then waited for, also where one fails: a copy reads our memory until it is done.
    std::exception_ptr fault;
    const auto attempt = [&](auto&& work) {
        try {
            work();
        } catch (...) {
            if (!fault) fault = std::current_exception();
        }
    };
    for (std::size_t k = 0; k < outputs.size() && !fault; ++k) attempt([&] { outputs[k].memory.write(columns_[k]); });
    for (const ContactOutput& output : outputs) attempt([&] { output.memory.finish(); });
    if (fault) std::rethrow_exception(fault);
}

} // namespace raycontact
