// SPDX-License-Identifier: Apache-2.0
#include <output/out_folder.h>

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::output;
namespace fs = std::filesystem;

namespace {

class Output : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("raycontact-output-test-" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    void put(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    std::string get(const std::string& name) const {
        std::ifstream in(folder_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }
    fs::path folder_;
};

} // namespace

TEST_F(Output, AFileTakesItsNameAtTheEnd) {
    put("a", "old");
    OutFile file(folder_ / "a");
    file.write("a longer text");
    file.write("new");
    EXPECT_EQ(get("a"), "old");
    EXPECT_EQ(file.keep(), folder_ / "a");
    EXPECT_EQ(get("a"), "new");
    EXPECT_EQ(files(), 1u);
}

TEST_F(Output, WhatIsNotKeptIsGone) {
    put("a", "old");
    {
        OutFile file(folder_ / "a");
        file.write("new");
    }
    EXPECT_EQ(get("a"), "old");
    EXPECT_EQ(files(), 1u);
}

TEST_F(Output, ANameIsClaimedOnce) {
    std::optional<OutFile> first(folder_ / "a");
    EXPECT_THROW(OutFile(folder_ / "a"), InputError);
    OutFile moved = std::move(*first);
    first.reset();
    EXPECT_THROW(OutFile(folder_ / "a"), InputError);
    moved.write("1");
    moved.keep();
    OutFile(folder_ / "a").write("2");
    EXPECT_EQ(get("a"), "1");
}

TEST_F(Output, WhatRunsLeftIsMovedAsideAndNamed) {
    put("a.part", "left");
    put("a.1.part", "left before");
    put("ab.part", "of another");
    OutFile file(folder_ / "a");
    EXPECT_EQ(get("a.2.part"), "left");
    EXPECT_EQ(file.left_overs(), (std::vector<fs::path>{folder_ / "a.1.part", folder_ / "a.2.part"}));
    file.write("new");
    file.leave();
    EXPECT_EQ(get("a.part"), "new");
    put("b.part", ""); // killed before it had anything
    EXPECT_TRUE(OutFile(folder_ / "b").left_overs().empty());
}

TEST_F(Output, WhatCannotBeWrittenIsRefused) {
    fs::create_directory(folder_ / "folder");
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    fs::create_directory(folder_ / "way.part");
    fs::create_symlink("nowhere", folder_ / "link.part");
    for (const std::string& name : {std::string("folder"), std::string("pipe"), std::string("pipe/a"),
                                    std::string("way"), std::string("link"), std::string(246, 'a')}) {
        try {
            const OutFile file(folder_ / name);
            ADD_FAILURE() << name;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
    EXPECT_NO_THROW(OutFile(folder_ / std::string(245, 'a')));
    EXPECT_NO_THROW(OutFile(folder_ / "none" / "yet" / "a")); // its folder is made
    EXPECT_TRUE(fs::is_directory(folder_ / "none" / "yet"));
}

TEST_F(Output, ALinkStaysALink) {
    put("target", "old");
    fs::create_symlink("target", folder_ / "link");
    OutFile file(folder_ / "link");
    file.write("new");
    file.keep();
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
    EXPECT_EQ(get("target"), "new");
}

TEST_F(Output, AFolderKeepsAllOrNothing) {
    put("one", "old");
    {
        OutFolder folder(folder_);
        folder.claim("never");
        folder.write("one", "new");
        folder.write("deep/two", "new");
        EXPECT_EQ(get("one"), "old");
    }
    EXPECT_FALSE(fs::exists(folder_ / "deep"));
    EXPECT_EQ(files(), 1u);
    OutFolder folder(folder_);
    folder.claim("never");
    folder.write("one", "new");
    folder.write("deep/two", "new");
    folder.keep();
    EXPECT_EQ(get("one") + get("deep/two"), "newnew");
    EXPECT_EQ(folder.kept("one"), folder_ / "one");
    EXPECT_EQ(files(), 2u);
}

TEST_F(Output, CutResultsLieBesideThoseThatAreThere) {
    OutFolder first(folder_);
    first.write("one", "cut");
    first.keep(true);
    EXPECT_EQ(get("one"), "cut");
    OutFolder second(folder_);
    second.write("one", "cut again");
    second.write("two", "cut again");
    second.keep(true);
    EXPECT_EQ(get("one"), "cut");
    EXPECT_EQ(get("one.cut") + get("two.cut"), "cut againcut again");
    EXPECT_EQ(second.kept("two"), folder_ / "two.cut");
    EXPECT_FALSE(fs::exists(folder_ / "two"));
}
