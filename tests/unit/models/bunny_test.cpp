// SPDX-License-Identifier: Apache-2.0
// The real bunny is in a package that tests must not need; a fine torus written as OBJ takes the same way.
#include <scenes/models/bunny.h>
#include <scenes/models/cache.h>
#include <scenes/models/procedural.h>
#include <scenes/models/simplify.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::scenes;

namespace {

class Bunny : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("raycontact-bunny-test-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        file_ = folder_ / "fine.obj";
        const Mesh fine = bumpy_torus(6000);
        std::ofstream out(file_);
        out.precision(9);
        for (const Vec3& v : fine.vertices) out << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
        for (const auto& t : fine.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
        ::setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
    }
    void TearDown() override {
        ::unsetenv("XDG_CACHE_HOME");
        std::filesystem::remove_all(folder_);
    }
    std::filesystem::path only_cached_file() const {
        std::filesystem::path found;
        for (const auto& entry : std::filesystem::directory_iterator(cache_folder())) {
            EXPECT_TRUE(found.empty()) << "more than one file in the cache";
            found = entry.path();
        }
        return found;
    }

    std::filesystem::path folder_, file_;
    std::string why_not_;
};

} // namespace

TEST_F(Bunny, IsReducedToTheExactCountAndSound) {
    for (const std::uint32_t triangles : {300u, 902u, 2130u}) {
        const auto model = reduced_bunny(file_, triangles, why_not_);
        ASSERT_TRUE(model) << why_not_;
        EXPECT_EQ(model->mesh.triangles.size(), triangles);
        EXPECT_TRUE(sound(prepare_mesh(model->mesh, {.repair = Repair::as_is}).report));
        EXPECT_FALSE(model->stand_in);
    }
}

TEST_F(Bunny, IsTakenFromTheCacheAndMadeAnewWhenThatIsDamaged) {
    const auto first = reduced_bunny(file_, 300, why_not_);
    ASSERT_TRUE(first) << why_not_;
    // A different, undamaged mesh in its place is what comes back: the cache is really read ...
    const std::filesystem::path cached = only_cached_file();
    const Mesh other = gear(300);
    ASSERT_TRUE(write_cached(cached, other));
    EXPECT_EQ(reduced_bunny(file_, 300, why_not_)->mesh.vertices, other.vertices);
    // ... and one damaged byte makes the true one again.
    std::fstream(cached, std::ios::binary | std::ios::in | std::ios::out).seekp(1000).put('\x5a').put('\x5b');
    ASSERT_FALSE(read_cached(cached));
    const auto again = reduced_bunny(file_, 300, why_not_);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->mesh.vertices, first->mesh.vertices);
    EXPECT_EQ(again->mesh.triangles, first->mesh.triangles);
    EXPECT_TRUE(read_cached(cached));
}

TEST_F(Bunny, OtherInputHasOtherCache) {
    const auto first = reduced_bunny(file_, 300, why_not_);
    std::ofstream(file_, std::ios::app) << "v 9 9 9\n"; // not in use: the same mesh, but other bytes
    const std::filesystem::path before = only_cached_file();
    ASSERT_TRUE(reduced_bunny(file_, 300, why_not_));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(cache_folder()), {}), 2) << before;
}

TEST_F(Bunny, SaysWhyNot) {
    EXPECT_FALSE(reduced_bunny(folder_ / "nothing.obj", 902, why_not_));
    EXPECT_NE(why_not_.find("glmark2-data"), std::string::npos);
    std::ofstream(file_) << "v 0 0\n";
    EXPECT_FALSE(reduced_bunny(file_, 902, why_not_));
    EXPECT_NE(why_not_.find("fine.obj"), std::string::npos) << why_not_;
}

TEST_F(Bunny, WithOrWithoutThePackageTheCountIsMet) {
    const Model model = scene_model("bunny", 902);
    EXPECT_EQ(model.mesh.triangles.size(), 902u);
    EXPECT_TRUE(sound(prepare_mesh(model.mesh, {.repair = Repair::as_is}).report));
    EXPECT_NE(model.source.find(model.stand_in ? "standing in for" : "Stanford bunny"), std::string::npos)
        << model.source;
}
