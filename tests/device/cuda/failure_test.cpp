// SPDX-License-Identifier: Apache-2.0
// Every call of driver and compiler fails once, or fails and with it all that follow, as on a device that is lost.
#include "device/cuda/fake_machine.h"

#include "device/gpu/launches.h"
#include "device/launch.h"
#include "device/scan.h"

#include <raycontact/error.h>

#include <functional>
#include <set>

using namespace raycontact;

namespace {

class Failing : public cuda_test::FakeMachine {
protected:
    // Fails the calls of one library, one after the other, in what `run` does; says how many there were.
    template <typename Fake>
    std::size_t fail_each(Fake& fake, bool stays_lost, const std::function<void()>& run);

    void forget() {
        std::filesystem::remove_all(cache);
        cuda.reset();
        nvrtc.reset();
    }
};

// What releases something: nobody is told that it failed. The first comes before each of them.
bool releases(const std::string& call) {
    static const std::set<std::string> names = {
        "cuCtxPushCurrent_v2", "cuCtxPopCurrent_v2", "cuStreamSynchronize",          "cuStreamDestroy_v2",
        "cuEventDestroy_v2",   "cuModuleUnload",     "cuDevicePrimaryCtxRelease_v2", "cuMemFree_v2",
        "cuMemFreeHost",       "nvrtcDestroyProgram"};
    return names.count(call) > 0;
}

template <typename Fake>
std::size_t Failing::fail_each(Fake& fake, bool stays_lost, const std::function<void()>& run) {
    const std::size_t step = stays_lost ? 3 : 1; // single failures are tried at every call
    for (std::size_t at = 1;; at += step) {
        forget();
        fake.fail_at = at;
        fake.stays_lost = stays_lost;
        bool threw = false;
        try {
            run();
        } catch (const InputError&) {
            threw = true;
        } catch (const DeviceError& error) {
            threw = true;
            EXPECT_NE(std::string(error.what()), "");
        }
        const std::string failed = fake.failed;
        if (failed.empty()) {
            EXPECT_FALSE(threw);
            return at - 1;
        }
        EXPECT_TRUE(threw || releases(failed)) << "call " << at << ", " << failed << ", failed and nobody was told";
        if (!stays_lost) {
            // What could not be released, or not be waited for, stays.
            if (threw || !releases(failed)) {
                EXPECT_EQ(cuda.alive, 0u) << "after call " << at << ", " << failed;
            }
            EXPECT_EQ(cuda.misuse, std::vector<std::string>{}) << "after call " << at << ", " << failed;
        }
        cuda.misuse.clear();
        if (testing::Test::HasFailure()) return at;
    }
}

void use(Device& device) {
    Queue& queue = device.queue();
    Array<kernels::uint> array, other;
    Array<kernels::Totals> totals;
    const std::vector<kernels::uint> values(std::size_t{1} << 18);
    array.resize(device, 4 * values.size());
    for (int i = 0; i < 6; ++i) queue.write(*array.buffer(), 0, values.data(), 4 * values.size());
    array.write(device, std::vector<kernels::uint>(3 * values.size()));
    other.extend(device, 10);
    other.extend(device, 100000);
    totals.resize(device, 1);
    queue.launch(KernelId::write_contacts, 7, gpu::Nothing<Prototype<KernelId::write_contacts>::type>::arguments);
    Columns table;
    table.resize(device, 1, 200000);
    table.scan(device, 10, totals, 0, 5);
    table.scan(device, 200000, totals, 0, 5);
    std::vector<kernels::uint> found(5);
    std::vector<kernels::Totals> sums(1);
    const Piece pieces[] = {array.piece(found), totals.piece(sums)};
    queue.read(pieces);
    queue.finish();
}

TEST_F(Failing, opening) {
    for (const bool stays_lost : {false, true}) EXPECT_GT(fail_each(cuda, stays_lost, [] { open(); }), 200u);
}

TEST_F(Failing, compiling) {
    for (const bool stays_lost : {false, true}) EXPECT_GT(fail_each(nvrtc, stays_lost, [] { open(); }), 10u);
}

TEST_F(Failing, working) {
    for (const bool stays_lost : {false, true}) {
        const std::size_t calls = fail_each(cuda, stays_lost, [&] {
            const std::size_t at = std::exchange(cuda.fail_at, 0);
            const auto device = open();
            if (at > 0) cuda.fail_at = cuda.calls.size() + at;
            use(*device);
        });
        EXPECT_GT(calls, 80u);
    }
}

// Buffers that outlive their device still find the context.
TEST_F(Failing, a_buffer_may_outlive_its_device) {
    auto device = open();
    auto buffer = device->make_buffer(100);
    device.reset();
    EXPECT_GT(cuda.alive, 0u);
    buffer.reset();
    EXPECT_EQ(cuda.alive, 0u);
}

} // namespace
