// SPDX-License-Identifier: Apache-2.0
// What the test libraries libcuda.so.1 and libnvrtc.so.12 record, and what they are told to do. They are real shared
// libraries that the real device code loads; the test finds these structs in them.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace raycontact::cuda_test {

struct Recorder {
    std::vector<std::string> calls;
    std::size_t fail_at = 0; ///< the n-th call from now on fails; 0: none
    bool stays_lost = false; ///< so do all after it
    std::string fails;       ///< every call of this function fails
    std::string failed;      ///< the first that was told to fail

    /// Records a call; true: it must fail. For a program run from outside, RAYCONTACT_FAKE_FAIL names a function.
    bool enter(const char* name) {
        calls.emplace_back(name);
        const char* outside = std::getenv("RAYCONTACT_FAKE_FAIL");
        const bool counted = fail_at > 0 && (calls.size() == fail_at || (stays_lost && calls.size() > fail_at));
        const bool fail = counted || fails == name || (outside && outside == calls.back());
        if (fail && failed.empty()) failed = name;
        return fail;
    }
    std::size_t count(const std::string& name) const {
        std::size_t number = 0;
        for (const std::string& call : calls) number += call == name;
        return number;
    }
};

struct Launch {
    std::string kernel;
    unsigned groups = 0, group_size = 0;
    std::vector<std::uint64_t> arguments; ///< addresses and numbers, as the kernel's own text declares them
};

struct FakeCuda : Recorder {
    int devices = 1, version = 12080, architecture = 90;
    std::vector<Launch> launches;
    std::vector<std::string> misuse; ///< what no driver would take, or no caller should do
    std::size_t alive = 0;           ///< allocations and handles not released
    void (*reset)() = nullptr;       ///< releases everything, forgets everything
};

struct FakeNvrtc : Recorder {
    int major = 12;
    std::vector<std::string> options; ///< of the last program
    void (*reset)() = nullptr;
};

} // namespace raycontact::cuda_test
