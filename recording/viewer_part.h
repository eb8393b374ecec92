// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/bytes.h>

#include <raycontact/pose.h>
#include <raycontact/shape.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace raycontact::recording {

// The part of a recording that glTF viewers read: float32, metres, seconds; the recording's z becomes glTF's y.

/// Unit quaternion x, y, z, w of a rotation matrix; the largest component is found first, so nothing cancels.
std::array<double, 4> quaternion(const std::array<double, 9>& rotation);

struct ViewerBody {
    std::uint32_t shape = 0;
    Pose start;
};

/// How one body moves; per time of the animation. Empty where it does not.
struct ViewerTrack {
    std::vector<std::array<float, 3>> translations;
    std::vector<std::array<float, 4>> rotations; ///< unit quaternions x, y, z, w; neighbours on the same half sphere
    std::vector<float> sizes;                    ///< 1 while the body is there, else 0; empty where it always is

    void add(const Pose& pose);
};

/// Header, JSON chunk and BIN chunk of a GLB file, the lengths right for a file that ends there. `tracks` is empty (a
/// still picture) or has one entry a body. Throws std::length_error beyond the 4 GiB of a GLB file.
Bytes viewer_part(std::span<const std::shared_ptr<const Shape>> shapes, std::span<const ViewerBody> bodies,
                  std::span<const float> times, std::span<const ViewerTrack> tracks);

namespace glb {
constexpr std::uint32_t magic = 0x46546c67, version = 2;        // "glTF"
constexpr std::uint32_t json = 0x4e4f534a, binary = 0x004e4942; // "JSON", "BIN\0"
constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8, length_at = 8;
} // namespace glb

} // namespace raycontact::recording
