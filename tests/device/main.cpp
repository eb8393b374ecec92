// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

int main(int argc, char** argv) {
    // Read when the first platform is asked for: two devices of PoCL, with two compute units even on one core.
    setenv("POCL_DEVICES", "pthread pthread", 0);
    setenv("POCL_MAX_PTHREAD_COUNT", "2", 0);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
