// SPDX-License-Identifier: Apache-2.0
// Memory of a CUDA device that belongs to the caller: what is copied, in which stream, and what is refused.
#include "device/cuda/fake_machine.h"
#include "device/cuda/handle.h"

#include <raycontact/error.h>
#include <raycontact/user_memory.h>

#include <array>
#include <optional>

using namespace raycontact;
using cuda::Address;
using cuda::driver;
using cuda::StreamHandle;

namespace {

class UserMemoryOnCuda : public cuda_test::FakeMachine {
public:
    UserMemoryOnCuda() {
        driver().cuInit(0);
        context.emplace(0);
        const cuda::Current current(*context);
        driver().cuMemAlloc(&address, 64);
        driver().cuStreamCreate(&stream, 0);
    }
    ~UserMemoryOnCuda() override {
        {
            const cuda::Current current(*context);
            driver().cuMemFree(address);
            driver().cuStreamDestroy(stream);
        }
        context.reset();
        EXPECT_EQ(cuda.alive, 0u);
    }
    std::vector<std::byte> content() {
        const auto* bytes = reinterpret_cast<const std::byte*>(address);
        return {bytes, bytes + 64};
    }

    std::optional<cuda::PrimaryContext> context;
    Address address = 0;
    StreamHandle stream = nullptr;
};

// What is written is there once it was waited for; what is read comes after what the stream had before.
TEST_F(UserMemoryOnCuda, is_copied_in_the_order_of_its_stream) {
    for (void* const own : {static_cast<void*>(stream), static_cast<void*>(nullptr)}) {
        const std::vector<std::byte> zeros(64);
        const std::array<std::byte, 3> three{std::byte{1}, std::byte{2}, std::byte{3}};
        UserMemory::cuda(address, 64, own).write(zeros);
        UserMemory::cuda(address, 64, own).finish();
        EXPECT_EQ(content(), zeros);
        const UserMemory memory = UserMemory::cuda(address + 8, 16, own);
        EXPECT_EQ(memory.bytes(), 16u);
        memory.write(three);
        EXPECT_EQ(content(), zeros) << "nothing waits yet";
        std::vector<std::byte> read(16);
        memory.read(read);
        EXPECT_EQ(std::vector(read.begin(), read.begin() + 3), std::vector(three.begin(), three.end()));
        EXPECT_EQ(content()[8], std::byte{1});
        EXPECT_EQ(content()[7], std::byte{0});
        std::vector<std::byte> more(17);
        EXPECT_THROW(memory.read(more), InputError);
        EXPECT_THROW(memory.write(more), InputError);
    }
}

// Who does not know the stream waits for all of them.
TEST_F(UserMemoryOnCuda, every_stream_is_waited_for) {
    const std::array<std::byte, 2> two{std::byte{5}, std::byte{6}};
    const UserMemory memory = UserMemory::cuda(address, 64, stream);
    memory.write(two);
    std::vector<std::byte> read(2);
    UserMemory::cuda(address, 64, UserMemory::every_stream()).read(read);
    EXPECT_EQ(read, std::vector(two.begin(), two.end()));
    EXPECT_EQ(UserMemory::cuda(0, 0).bytes(), 0u) << "an empty array has no address";
}

TEST_F(UserMemoryOnCuda, what_is_no_memory_of_a_device_is_refused) {
    int on_the_host = 0;
    EXPECT_THROW(UserMemory::cuda(reinterpret_cast<std::uintptr_t>(&on_the_host), 4), InputError);
    EXPECT_THROW(UserMemory::cuda(0, 4), InputError);
}

// Each call of the driver fails in turn: an error is told, and nothing stays retained.
TEST_F(UserMemoryOnCuda, whichever_call_fails_it_is_told) {
    std::vector<std::byte> bytes(8);
    const auto use = [&] {
        const UserMemory memory = UserMemory::cuda(address, 8, stream);
        memory.write(bytes);
        memory.finish();
        memory.read(bytes);
    };
    cuda.calls.clear();
    use();
    const std::vector<std::string> calls = cuda.calls;
    EXPECT_GT(calls.size(), 8u);
    for (std::size_t call = 1; call <= calls.size(); ++call) {
        const std::string& name = calls[call - 1];
        // Nobody is told of these.
        if (name == "cuCtxPopCurrent_v2" || name == "cuDevicePrimaryCtxRelease_v2") continue;
        cuda.calls.clear();
        cuda.fail_at = call;
        EXPECT_THROW(use(), std::runtime_error) << name;
        cuda.fail_at = 0;
        const cuda::Current current(*context);
        driver().cuStreamSynchronize(stream); // copies that nobody waited for
    }
}

} // namespace
