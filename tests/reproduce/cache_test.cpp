// SPDX-License-Identifier: Apache-2.0
#include "program.h"

#include <raycontact/error.h>
#include <reproduce/cache.h>

#include <gtest/gtest.h>

#include <fstream>

namespace raycontact::reproduce {
namespace {

TEST(Cache, FindsWhatWasKeptByItsKeyAlone) {
    const TemporaryFolder folder;
    const Cache cache(folder.path() / "cache");
    const Json key{{"seed", 1}};
    EXPECT_FALSE(cache.find("part", key));
    cache.keep("part", key, {{"value", 0.1}});
    EXPECT_EQ(Cache(folder.path() / "cache").find("part", key), Json({{"value", 0.1}}));
    EXPECT_FALSE(cache.find("part", Json{{"seed", 2}}));
    EXPECT_FALSE(cache.find("other", key));
}

TEST(Cache, DamageIsAsIfItWereNotThere) {
    const TemporaryFolder folder;
    const Cache cache(folder.path());
    const Json key{{"seed", 1}}, other{{"seed", 2}};
    cache.keep("part", key, 1);
    std::filesystem::copy_file(cache.file("part", key, ".json"), cache.file("part", other, ".json"));
    EXPECT_FALSE(cache.find("part", other)) << "the name's hash is not enough";
    std::filesystem::resize_file(cache.file("part", key, ".json"), 9);
    EXPECT_FALSE(cache.find("part", key));
    cache.keep("part", key, 2);
    EXPECT_EQ(cache.find("part", key), Json(2));
}

TEST(Cache, AFolderThatCannotBeMadeIsNamed) {
    const TemporaryFolder folder;
    folder.write("file", "");
    try {
        const Cache cache(folder.path() / "file");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("file: cannot be made a folder"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace raycontact::reproduce
