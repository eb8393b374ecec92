// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/library_mode.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace raycontact {

/// A stretch of memory that belongs to the caller, of the host or of a device: Scene::set_poses() reads it,
/// Scene::write_contacts() writes it, whatever device the scene works on. Cheap to copy. The caller keeps the memory
/// for as long as it is used.
class RAYCONTACT_API UserMemory {
public:
    /// Of the host: an array of the caller's.
    static UserMemory host(std::span<std::byte> bytes);
    /// Of a CUDA device: an address as cudaMalloc, torch, CuPy or Warp give it. It is read after what its stream was
    /// given before, and written before what the stream is given after. stream: a cudaStream_t or CUstream of the same
    /// device's primary context; null: the default stream. Throws InputError where there is no CUDA driver, where this
    /// version was built without CUDA, and for an address that is none of a device.
    static UserMemory cuda(std::uint64_t address, std::size_t bytes, void* stream = nullptr);
    /// As a stream: whatever the device was given before is done before the memory is read or written.
    static void* every_stream() noexcept;
    /// Of an OpenCL buffer. queue: a cl_command_queue, in order, as a CUDA stream above. buffer: a cl_mem of its
    /// context. Both are retained. offset: bytes before the stretch. Throws InputError where the buffer is shorter or
    /// of another context, and where this version was built without OpenCL.
    static UserMemory opencl(void* queue, void* buffer, std::size_t bytes, std::size_t offset = 0);

    /// Of the stretch.
    std::size_t bytes() const noexcept { return bytes_; }

    /// Copies the first bytes; returns when they are there. Throws InputError for more than there are, and
    /// std::runtime_error where the device fails, as those below.
    void read(std::span<std::byte> to) const;
    /// Begins to copy to the first bytes. `from` must stay as it is until finish() returns.
    void write(std::span<const std::byte> from) const;
    /// Waits for what was begun.
    void finish() const;

    /// How one kind of memory is reached.
    class RAYCONTACT_HIDDEN Access;
    /// Of the functions above.
    RAYCONTACT_HIDDEN UserMemory(std::shared_ptr<const Access> access, std::size_t bytes);

private:
    std::shared_ptr<const Access> access_;
    std::size_t bytes_;
};

/// How poses lie in memory, one after the other; body to world, metres.
enum class PoseForm {
    matrix_4x4,    ///< 16 numbers, row-major, the translation in the last column
    matrix_3x4,    ///< its first three rows, 12 numbers
    position_wxyz, ///< 7 numbers: translation, unit quaternion with the real part first (MuJoCo)
    position_xyzw, ///< 7 numbers: the real part last (Warp, PhysX, Bullet, ROS)
};

/// Of what numbers an array is.
enum class NumberType { float32, float64 };

} // namespace raycontact
