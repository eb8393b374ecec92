// SPDX-License-Identifier: Apache-2.0
// In place of libFuzzer: hands each file named, and each file of a folder named, to a target. With every compiler.
#include "fuzz/input.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

int main(int argc, char** argv) {
    std::vector<std::filesystem::path> files;
    for (int i = 1; i < argc; ++i) {
        if (!std::filesystem::is_directory(argv[i])) {
            files.emplace_back(argv[i]);
            continue;
        }
        for (const auto& entry : std::filesystem::directory_iterator(argv[i])) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    if (files.empty()) {
        std::fprintf(stderr, "%s: no files to replay; name files or a folder of them\n", argv[0]);
        return 2;
    }
    for (const auto& file : files) {
        std::ifstream in(file, std::ios::binary);
        if (!in) {
            std::fprintf(stderr, "%s: cannot be read\n", file.c_str());
            return 2;
        }
        std::printf("%s\n", file.c_str());
        std::fflush(stdout); // the last name before a crash is the culprit's
        const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    std::printf("%zu inputs; what they stand for was taken %llu times\n", files.size(),
                static_cast<unsigned long long>(raycontact::fuzz::times_taken()));
    // A corpus that is refused as a whole tries nothing but the first check: the format has changed, make seeds anew.
    return raycontact::fuzz::times_taken() == 0 ? 1 : 0;
}
