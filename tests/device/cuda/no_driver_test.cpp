// SPDX-License-Identifier: Apache-2.0
#include "device/device.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <dlfcn.h>

using namespace raycontact;

// Most machines: nothing is listed, and asking for it is bad usage.
TEST(no_driver, is_no_device) {
    if (dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL)) GTEST_SKIP() << "there is a CUDA driver here";
    for (const DeviceInfo& info : list_devices()) EXPECT_NE(info.kind, "cuda");
    try {
        open_device("cuda:0", 1);
        FAIL() << "it was opened";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("'cuda:0': no CUDA driver is installed here"), std::string::npos)
            << error.what();
    }
}
