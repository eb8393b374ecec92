// SPDX-License-Identifier: Apache-2.0
#include "device/user_memory.h"
#include "device/opencl/handle.h"

#include <raycontact/error.h>

namespace raycontact::opencl {

namespace {

class Stretch : public UserMemory::Access {
public:
    Stretch(cl_command_queue queue, cl_mem buffer, std::size_t bytes, std::size_t offset) : offset_(offset) {
        const std::string named = "memory of an OpenCL buffer: ";
        cl_context of_queue = nullptr, of_buffer = nullptr;
        std::size_t size = 0;
        // NOLINTBEGIN(bugprone-sizeof-expression): a context is a handle
        if (queue == nullptr
            || clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof of_queue, &of_queue, nullptr) != CL_SUCCESS)
            throw InputError(named + "the queue is none");
        if (buffer == nullptr
            || clGetMemObjectInfo(buffer, CL_MEM_CONTEXT, sizeof of_buffer, &of_buffer, nullptr) != CL_SUCCESS
            || clGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof size, &size, nullptr) != CL_SUCCESS)
            throw InputError(named + "the buffer is none");
        // NOLINTEND(bugprone-sizeof-expression)
        if (of_queue != of_buffer) throw InputError(named + "it is of another context than the queue");
        if (offset > size || bytes > size - offset)
            throw InputError(named + "it has " + std::to_string(size) + " bytes, not " + std::to_string(bytes)
                             + " from byte " + std::to_string(offset) + " on");
        check(clRetainCommandQueue(queue), "clRetainCommandQueue");
        queue_.reset(queue);
        check(clRetainMemObject(buffer), "clRetainMemObject");
        buffer_.reset(buffer);
    }

    void read(std::span<std::byte> to) const override {
        check(clEnqueueReadBuffer(queue_.get(), buffer_.get(), CL_FALSE, offset_, to.size(), to.data(), 0, nullptr,
                                  nullptr),
              "clEnqueueReadBuffer");
    }
    void write(std::span<const std::byte> from) const override {
        check(clEnqueueWriteBuffer(queue_.get(), buffer_.get(), CL_FALSE, offset_, from.size(), from.data(), 0, nullptr,
                                   nullptr),
              "clEnqueueWriteBuffer");
    }
    void finish() const override { check(clFinish(queue_.get()), "clFinish"); }

private:
    CommandQueue queue_;
    Memory buffer_;
    std::size_t offset_;
};

} // namespace

std::shared_ptr<const UserMemory::Access> user_memory(void* queue, void* buffer, std::size_t bytes,
                                                      std::size_t offset) {
    return std::make_shared<Stretch>(static_cast<cl_command_queue>(queue), static_cast<cl_mem>(buffer), bytes, offset);
}

} // namespace raycontact::opencl
