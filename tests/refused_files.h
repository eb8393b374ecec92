// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace raycontact {

/// Files that load_mesh() refuses, and words of the reason.
using RefusedFiles = std::map<std::string, std::string>;

/// Every file of a folder loads but for those that are refused, each for what it is.
inline void expect_all_load_but(const RefusedFiles& refused, const std::filesystem::path& folder,
                                const std::vector<std::string>& files, std::size_t wanted) {
    std::size_t loaded = 0;
    std::set<std::string> refused_here;
    for (const std::string& file : files) {
        SCOPED_TRACE(file);
        const auto reason = refused.find(file);
        try {
            EXPECT_FALSE(load_mesh(folder / file).triangles.empty());
            EXPECT_EQ(reason, refused.end()) << "it loads now";
            ++loaded;
        } catch (const InputError& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find(std::filesystem::path(file).filename().string()), std::string::npos) << what;
            EXPECT_NE(what.find(reason == refused.end() ? "nothing" : reason->second), std::string::npos) << what;
            refused_here.insert(file);
        }
    }
    EXPECT_EQ(refused_here.size(), refused.size());
    EXPECT_EQ(loaded, wanted);
}

} // namespace raycontact
