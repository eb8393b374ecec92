// SPDX-License-Identifier: Apache-2.0
// Each call of the CUDA driver in a step fails in turn. The CPU takes over, and no contact is lost.
#include "device/cuda/fake_machine.h"

#include "device/moving_crowd.h"
#include "narrow_phase.h"

using namespace raycontact;
using device_test::MovingCrowd;
using device_test::same;

namespace {

class Step : public cuda_test::FakeMachine {};

std::vector<OpenDevice> cpu_and(std::unique_ptr<Device> other) {
    std::vector<OpenDevice> devices;
    if (other) devices.push_back({std::make_unique<Executor>(1), std::move(other)});
    devices.push_back(open_device("cpu", 1));
    return devices;
}

// before and after: of the step alone, without opening and closing.
std::vector<Contact> step_on(std::vector<OpenDevice> devices, const MovingCrowd& crowd, Method method,
                             const std::function<void()>& before, const std::function<void()>& after,
                             StepStats& stats) {
    Settings settings;
    settings.method = method;
    settings.execution.schedule = Schedule::counted;
    NarrowPhase narrow(settings, std::move(devices));
    for (const auto& shape : crowd.shapes) narrow.parts().add_shape(shape);
    const SlotChanges moved;
    OpenPairs pairs;
    pairs.set_all(narrow.parts().executor(), crowd.pairs);
    before();
    narrow.step(crowd.bodies, moved, pairs, stats);
    after();
    return *narrow.contacts().shared();
}

TEST_F(Step, is_complete_whichever_call_fails) {
    const MovingCrowd crowd(10, 0.8);
    for (const Method method : {Method::standard, Method::iterative}) {
        StepStats stats;
        const std::vector<Contact> expected = step_on(
            cpu_and(nullptr), crowd, method, [] {}, [] {}, stats);
        ASSERT_GT(expected.size(), 100u);
        for (const bool stays_lost : {false, true}) {
            std::size_t lost = 0, silent = 0;
            for (std::size_t at = 1;; ++at) {
                cuda.reset();
                const std::vector<Contact> found = step_on(
                    cpu_and(open()), crowd, method,
                    [&] {
                        cuda.fail_at = cuda.calls.size() + at;
                        cuda.stays_lost = stays_lost;
                    },
                    [&] {
                        cuda.fail_at = 0;
                        cuda.stays_lost = false;
                    },
                    stats);
                const bool reached = !cuda.failed.empty();
                cuda.misuse.clear(); // of what is released after a failure
                if (!reached) break;
                // A release that fails is not noticed; the test driver computes nothing, so its contacts are not there.
                if (stats.devices_lost == 0) {
                    ++silent;
                    EXPECT_TRUE(cuda.failed == "cuCtxPopCurrent_v2" || cuda.failed == "cuMemFree_v2"
                                || cuda.failed == "cuCtxPushCurrent_v2" || cuda.failed == "cuStreamSynchronize"
                                || cuda.failed == "cuEventDestroy_v2")
                        << cuda.failed;
                    continue;
                }
                ++lost;
                EXPECT_EQ(stats.warnings.size(), 1u);
                ASSERT_TRUE(same(found, expected)) << to_string(method) << ", call " << at << ", " << cuda.failed;
            }
            EXPECT_GT(lost, 60u);
            EXPECT_LT(silent, lost);
        }
    }
}

} // namespace
