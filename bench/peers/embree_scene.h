// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>

namespace raycontact::bench {

/// An Embree device of one thread that counts its memory.
class EmbreeDevice {
public:
    EmbreeDevice();
    ~EmbreeDevice() { rtcReleaseDevice(device_); }
    EmbreeDevice(const EmbreeDevice&) = delete;
    EmbreeDevice& operator=(const EmbreeDevice&) = delete;

    RTCDevice get() const { return device_; }
    std::uint64_t bytes() const { return static_cast<std::uint64_t>(bytes_.load()); }

private:
    std::atomic<std::int64_t> bytes_{0};
    RTCDevice device_;
};

/// One shape, vertices relative to its centre in float32 as our kernels see them; robust, high quality.
class EmbreeScene {
public:
    EmbreeScene(const EmbreeDevice& device, const Shape& shape);
    ~EmbreeScene() { rtcReleaseScene(scene_); }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// The closest hit by rtcIntersect1; whether there is one within `reach` and it is a face met from inside.
    bool cast(const float* position, const float* direction, float reach, RTCRayHit& hit) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        hit.ray.org_x = position[0];
        hit.ray.org_y = position[1];
        hit.ray.org_z = position[2];
        hit.ray.dir_x = direction[0];
        hit.ray.dir_y = direction[1];
        hit.ray.dir_z = direction[2];
        hit.ray.tnear = 0;
        hit.ray.tfar = reach;
        hit.ray.time = 0;
        hit.ray.mask = 0xffffffffu;
        hit.ray.id = 0;
        hit.ray.flags = 0;
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &hit);
        return hit.hit.geomID != RTC_INVALID_GEOMETRY_ID
               && hit.hit.Ng_x * direction[0] + hit.hit.Ng_y * direction[1] + hit.hit.Ng_z * direction[2] > 0;
    }

private:
    RTCScene scene_;
};

} // namespace raycontact::bench
