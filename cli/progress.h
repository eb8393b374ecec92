// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

/// A bar on standard error, on a terminal only; anywhere else it is silent.
class Progress {
public:
    Progress(std::string title, std::uint32_t total);
    void show(std::uint32_t now);
    void done();

private:
    std::string title_;
    std::uint32_t total_;
    std::uint32_t shown_ = 0; ///< percent
    bool terminal_;
};
