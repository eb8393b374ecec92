// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/fakes.h"

#include "device/device.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace raycontact::cuda_test {

/// A machine with the test driver and the test compiler, and an empty cache.
class FakeMachine : public testing::Test {
public:
    FakeMachine();
    ~FakeMachine() override;

protected:
    /// As `--inexact`: the test driver computes nothing, so that its bits are not the host's.
    static std::unique_ptr<Device> open();
    /// What opening says; empty if it opens.
    static std::string refusal(const char* id = "cuda:0", bool inexact = true);

    FakeCuda& cuda;
    FakeNvrtc& nvrtc;
    const std::filesystem::path cache;
};

} // namespace raycontact::cuda_test
