// SPDX-License-Identifier: Apache-2.0
// Each shell line of README and two pages of docs as it stands, one after another in a folder of its own.
#include "program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>

namespace {

/// The lines of all fenced blocks of shell, comments and empty ones left out.
std::vector<std::string> shell_lines(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<std::string> lines;
    bool inside = false;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("```")) {
            inside = line == "```sh";
            continue;
        }
        const std::size_t first = line.find_first_not_of(' ');
        if (inside && first != std::string::npos && line[first] != '#') lines.push_back(line);
    }
    return lines;
}

/// Such a line builds or installs: the other tests are what it made.
bool builds(const std::string& line) {
    constexpr std::string_view tools[] = {"scripts/", "cmake ", "apt-get ", "python3 -m pip "};
    return std::any_of(std::begin(tools), std::end(tools), [&](auto tool) { return line.starts_with(tool); });
}

/// Such a line says to the reader that it takes minutes; scripts/test long runs it.
bool takes_minutes(const std::string& line) {
    return line.ends_with("(minutes)");
}

TEST(Readme, EachShellLineRuns) {
    const TemporaryFolder folder;
    const std::filesystem::path source = RAYCONTACT_SOURCE_FOLDER;
    std::filesystem::create_directory(folder.path() / "build");
    std::filesystem::create_directory_symlink(std::filesystem::path(RAYCONTACT_PROGRAM_FILE).parent_path(),
                                              folder.path() / "build/bin");
    std::filesystem::create_directory_symlink(source / "docs", folder.path() / "docs");
    const bool all = std::getenv("RAYCONTACT_MINUTES") != nullptr;
    std::size_t ran = 0;
    std::vector<std::string> all_lines = shell_lines(source / "README.md");
    for (const char* page : {"docs/program.md", "docs/assembly-motion.md"})
        std::ranges::copy(shell_lines(source / page), std::back_inserter(all_lines));
    for (std::string line : all_lines) {
#ifdef RAYCONTACT_WITH_BENCH
        if (constexpr std::string_view script = "scripts/bench "; line.starts_with(script))
            line.replace(0, script.size(), "build/bin/raycontact-bench ");
#endif
        if (builds(line) || (takes_minutes(line) && !all)) continue;
        ASSERT_TRUE(line.starts_with("build/bin/raycontact")) << "neither ours nor a build: " << line;
        std::cerr << line << '\n';
        const auto result = StartedProgram({}, folder.path(), {}, {"/bin/sh", "-c", line}).wait();
        EXPECT_EQ(result.status, 0) << line << '\n' << result.err;
        ++ran;
    }
    EXPECT_GE(ran, 20u);
}

} // namespace
