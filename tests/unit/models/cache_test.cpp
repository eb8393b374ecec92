// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/cache.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::scenes;

namespace {

class Cache : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("raycontact-cache-test-" + std::to_string(::getpid()));
        file_ = folder_ / "inner" / "gear.mesh"; // a folder that is not there yet
        mesh_ = gear(120);
        ASSERT_TRUE(write_cached(file_, mesh_));
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string bytes() const {
        std::ifstream in(file_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void overwrite(const std::string& bytes) const {
        std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
    }

    std::filesystem::path folder_, file_;
    Mesh mesh_;
};

} // namespace

TEST_F(Cache, GivesBackWhatWasWritten) {
    const auto read = read_cached(file_);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->vertices, mesh_.vertices);
    EXPECT_EQ(read->triangles, mesh_.triangles);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file_.parent_path()), {}), 1)
        << "a draft was left behind";
}

TEST_F(Cache, ADamagedFileIsNoMesh) {
    const std::string good = bytes();
    for (std::size_t at = 0; at < good.size(); at += 37) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 0x10);
        overwrite(bad);
        EXPECT_FALSE(read_cached(file_)) << "byte " << at;
    }
    for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{31}, good.size() / 2, good.size() - 1}) {
        overwrite(good.substr(0, size));
        EXPECT_FALSE(read_cached(file_)) << size << " bytes";
    }
    overwrite(good + "x");
    EXPECT_FALSE(read_cached(file_));
    overwrite(good);
    EXPECT_TRUE(read_cached(file_));
}

TEST_F(Cache, MissingFilesAndFoldersAreNoError) {
    EXPECT_FALSE(read_cached(folder_ / "nothing.mesh"));
    EXPECT_FALSE(read_cached(folder_));
    EXPECT_FALSE(write_cached(file_ / "a-file-is-no-folder" / "x.mesh", mesh_));
    EXPECT_FALSE(hash_of_file(folder_ / "nothing.mesh"));
}
