// SPDX-License-Identifier: Apache-2.0
// A recording cut short or changed is told in one line, or, where only the viewers' part is hurt, still exact.
#include "sample.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <random>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

enum class Outcome { refused, exact, wrong };

Outcome try_reading(const Sample& sample, const std::filesystem::path& file, std::string& message) {
    try {
        Reader reader(file);
        message = difference(sample, reader, sample.steps());
        return message.empty() ? Outcome::exact : Outcome::wrong;
    } catch (const InputError& error) {
        message = error.what();
        EXPECT_NE(message.find(file.string()), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return Outcome::refused;
    }
}

class DamagedFile : public testing::TestWithParam<bool> {};

} // namespace

TEST_P(DamagedFile, TruncatedAnywhereItIsRefused) {
    const Sample sample = make_sample(40);
    const TemporaryFile file;
    record(sample, file.path(), GetParam());
    const std::vector<unsigned char> whole = bytes_of(file.path());
    std::string message;
    for (std::size_t k = 0; k < 50; ++k) {
        auto part = whole;
        part.resize(whole.size() * k / 50);
        write_bytes(file.path(), part);
        EXPECT_EQ(try_reading(sample, file.path(), message), Outcome::refused) << k;
        EXPECT_NE(message.find("truncated"), std::string::npos) << message;
    }
    for (std::size_t less = 1; less < 60; ++less) {
        auto part = whole;
        part.resize(whole.size() - less);
        write_bytes(file.path(), part);
        EXPECT_EQ(try_reading(sample, file.path(), message), Outcome::refused) << less;
    }
}

TEST_P(DamagedFile, AByteChangedAnywhereIsToldOrHarmless) {
    const Sample sample = make_sample(40);
    const TemporaryFile file;
    record(sample, file.path(), GetParam());
    const std::vector<unsigned char> whole = bytes_of(file.path());
    const std::size_t side = side_chunk_at(whole);
    ASSERT_LT(side, whole.size());
    std::mt19937_64 numbers(5);
    int refused = 0, exact = 0;
    for (int i = 0; i < 2000; ++i) {
        // Half of them where the exact data is.
        const std::size_t at = i % 2 == 0 ? numbers() % whole.size() : side + numbers() % (whole.size() - side);
        auto bytes = whole;
        bytes[at] = static_cast<unsigned char>(bytes[at] ^ (1 + numbers() % 255));
        write_bytes(file.path(), bytes);
        std::string message;
        const Outcome outcome = try_reading(sample, file.path(), message);
        ASSERT_NE(outcome, Outcome::wrong) << "byte " << at << ": " << message;
        if (at >= side + 4) { // past its length
            EXPECT_EQ(outcome, Outcome::refused) << "byte " << at;
        }
        ++(outcome == Outcome::refused ? refused : exact);
    }
    EXPECT_GT(refused, 900);
    EXPECT_GT(exact, 100);
}

INSTANTIATE_TEST_SUITE_P(Recording, DamagedFile, testing::Values(true, false));

TEST(ForeignFiles, AreToldApart) {
    const Sample sample = make_sample(3);
    const TemporaryFile file;
    record(sample, file.path(), true);
    const std::vector<unsigned char> whole = bytes_of(file.path());
    const std::size_t side = side_chunk_at(whole);
    const auto message_for = [&](const std::vector<unsigned char>& bytes) {
        write_bytes(file.path(), bytes);
        std::string message;
        EXPECT_EQ(try_reading(sample, file.path(), message), Outcome::refused);
        return message;
    };
    EXPECT_NE(message_for({}).find("truncated"), std::string::npos);
    EXPECT_NE(message_for(std::vector<unsigned char>(500, 'x')).find("not a .glb"), std::string::npos);

    auto without(whole);
    without.resize(side);
    for (std::size_t i = 0; i < 4; ++i) without[8 + i] = static_cast<unsigned char>(side >> (8 * i));
    EXPECT_NE(message_for(without).find("without exact data"), std::string::npos);

    auto newer(whole);
    newer[side + 8 + 8] = 9;
    EXPECT_NE(message_for(newer).find("version 9"), std::string::npos);
}
