// SPDX-License-Identifier: Apache-2.0
#include "contacts/column_writer.h"

#include "reference/random.h"

#include <raycontact/error.h>

#include <cstring>
#include <gtest/gtest.h>
#include <string>

namespace raycontact {
namespace {

constexpr ContactColumn every_column[] = {ContactColumn::slots,  ContactColumn::bodies,  ContactColumn::key,
                                          ContactColumn::kind,   ContactColumn::source,  ContactColumn::indices,
                                          ContactColumn::is_new, ContactColumn::point_a, ContactColumn::point_b,
                                          ContactColumn::normal, ContactColumn::depth,   ContactColumn::ray_length,
                                          ContactColumn::weight};

std::vector<Contact> some_contacts(std::uint32_t count) {
    reference::Random random(1);
    std::vector<Contact> contacts(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Contact& c = contacts[i];
        c.body_a = {i, random.below(5)};
        c.body_b = {i + 1 + random.below(9), random.below(5)};
        const Side source = random.below(2) == 0 ? Side::a : Side::b;
        c.feature = {static_cast<FeatureKind>(i % 3), i % 3 == 1 ? Side::a : source, random.below(100),
                     random.below(100)};
        c.is_new = random.below(2) == 0;
        c.normal = {0.25f * float(i), -1, 0.5f};
        c.depth = 0.125f * float(i) - 1;
        c.ray_length = 3 + float(i);
        c.weight = 0.5f;
        c.point_a = {1e-9 * i, 2.0 * i, -7};
        c.point_b = {1.0 / 3, -double(i), 1e6};
    }
    return contacts;
}

template <class Number>
std::vector<Number> numbers_in(const std::vector<std::byte>& bytes) {
    std::vector<Number> numbers(bytes.size() / sizeof(Number));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
    return numbers;
}

// Two of three rows of room are used; what lies behind them stays.
TEST(ContactColumns, HaveWhatTheContactsSay) {
    const std::vector<Contact> contacts = some_contacts(3000);
    Executor executor(2);
    ContactColumnWriter writer;
    const auto written = [&](ContactColumn column, NumberType points = NumberType::float64) {
        const std::size_t size = bytes_of(column, points);
        std::vector<std::byte> memory(size * 3 * contacts.size() / 2, std::byte{0xcd});
        writer.run(executor, contacts, std::vector<ContactOutput>{{column, UserMemory::host(memory), points}});
        for (std::size_t i = size * contacts.size(); i < memory.size(); ++i) EXPECT_EQ(memory[i], std::byte{0xcd});
        memory.resize(size * contacts.size());
        return memory;
    };
    const auto slots = numbers_in<std::uint32_t>(written(ContactColumn::slots));
    const auto bodies = numbers_in<std::uint32_t>(written(ContactColumn::bodies));
    const auto keys = numbers_in<std::uint64_t>(written(ContactColumn::key));
    const auto kinds = numbers_in<std::uint8_t>(written(ContactColumn::kind));
    const auto sources = numbers_in<std::uint8_t>(written(ContactColumn::source));
    const auto indices = numbers_in<std::uint32_t>(written(ContactColumn::indices));
    const auto fresh = numbers_in<std::uint8_t>(written(ContactColumn::is_new));
    const auto a = numbers_in<double>(written(ContactColumn::point_a));
    const auto b = numbers_in<float>(written(ContactColumn::point_b, NumberType::float32));
    const auto normals = numbers_in<float>(written(ContactColumn::normal));
    const auto depths = numbers_in<float>(written(ContactColumn::depth));
    const auto lengths = numbers_in<float>(written(ContactColumn::ray_length));
    const auto weights = numbers_in<float>(written(ContactColumn::weight));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& c = contacts[i];
        ASSERT_EQ(slots[2 * i], c.body_a.slot);
        ASSERT_EQ(slots[2 * i + 1], c.body_b.slot);
        ASSERT_EQ((BodyId{bodies[4 * i], bodies[4 * i + 1]}), c.body_a);
        ASSERT_EQ((BodyId{bodies[4 * i + 2], bodies[4 * i + 3]}), c.body_b);
        ASSERT_EQ(keys[i], c.key());
        ASSERT_EQ(kinds[i], static_cast<std::uint8_t>(c.feature.kind));
        ASSERT_EQ(sources[i], static_cast<std::uint8_t>(c.feature.source));
        ASSERT_EQ(indices[2 * i], c.feature.index_a);
        ASSERT_EQ(indices[2 * i + 1], c.feature.index_b);
        ASSERT_EQ(fresh[i], c.is_new ? 1 : 0);
        ASSERT_EQ((Vec3{a[3 * i], a[3 * i + 1], a[3 * i + 2]}), c.point_a);
        ASSERT_EQ(b[3 * i], static_cast<float>(c.point_b.x));
        ASSERT_EQ(b[3 * i + 2], static_cast<float>(c.point_b.z));
        ASSERT_EQ((Vec3f{normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]}), c.normal);
        ASSERT_EQ(depths[i], c.depth);
        ASSERT_EQ(lengths[i], c.ray_length);
        ASSERT_EQ(weights[i], c.weight);
    }
}

TEST(ContactColumns, NothingIsWrittenWhereOneHasNoRoom) {
    const std::vector<Contact> contacts = some_contacts(10);
    Executor executor(1);
    ContactColumnWriter writer;
    std::vector<std::byte> depths(40, std::byte{0xcd}), normals(119);
    try {
        writer.run(executor, contacts,
                   std::vector<ContactOutput>{{ContactColumn::depth, UserMemory::host(depths)},
                                              {ContactColumn::normal, UserMemory::host(normals)}});
        FAIL() << "it had no room";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("column normal has room for 9 contacts, and there are 10"),
                  std::string::npos)
            << error.what();
    }
    EXPECT_EQ(depths, std::vector<std::byte>(40, std::byte{0xcd}));
    writer.run(executor, {}, std::vector<ContactOutput>{{ContactColumn::depth, UserMemory::host({})}});
}

TEST(ContactColumns, HaveWords) {
    for (const ContactColumn column : every_column) EXPECT_EQ(contact_column_from(to_string(column)), column);
    EXPECT_THROW(contact_column_from("points"), InputError);
}

} // namespace
} // namespace raycontact
