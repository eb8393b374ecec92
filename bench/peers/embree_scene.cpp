// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/embree_scene.h>

#include "shape/shape_data.h"

namespace raycontact::bench {

EmbreeDevice::EmbreeDevice() : device_(rtcNewDevice("threads=1")) {
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* count, ssize_t bytes, bool) {
            *static_cast<std::atomic<std::int64_t>*>(count) += static_cast<std::int64_t>(bytes);
            return true;
        },
        &bytes_);
}

EmbreeScene::EmbreeScene(const EmbreeDevice& device, const Shape& shape) : scene_(rtcNewScene(device.get())) {
    RTCGeometry mesh = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto& points = shape.data().points;
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), points.size()));
    for (const Point3f& point : points) {
        *v++ = point.x;
        *v++ = point.y;
        *v++ = point.z;
    }
    auto* t = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                  3 * sizeof(std::uint32_t), shape.triangles().size()));
    for (const auto& triangle : shape.triangles())
        for (const std::uint32_t corner : triangle) *t++ = corner;
    rtcSetGeometryBuildQuality(mesh, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
}

} // namespace raycontact::bench
