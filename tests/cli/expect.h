// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

/// Status 2, nothing on stdout, one line on stderr that names `named`.
inline void expect_refused(const ProgramResult& result, const std::string& named) {
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(result.err.ends_with('\n')) << result.err;
    EXPECT_TRUE(result.err.starts_with("raycontact: ")) << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << "\"" << named << "\" is not in: " << result.err;
    EXPECT_LT(result.err.size(), 1000u) << result.err;
}
