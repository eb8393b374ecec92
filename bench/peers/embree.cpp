// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/embree_scene.h>
#include <bench/peers/entrants.h>

#include "pairs/directed_pairs.h"
#include "shape/shape_data.h"

#include <cmath>

namespace raycontact::bench {

namespace {

/// The rule as one writes it down with a ray tracer at hand: every vertex against the other's box, then its ray.
class Embree : public Peer {
public:
    explicit Embree(const Work& work) : work_(work) {
        for (const auto& shape : work.shapes) {
            scenes_.push_back(std::make_unique<EmbreeScene>(device_, *shape));
            std::vector<Source>& sources = sources_.emplace_back();
            for (std::size_t v = 0; v < shape->vertices().size(); ++v) {
                const Vec3 n = shape->vertex_normals()[v];
                const Point3f p = shape->data().points[v];
                if (n == Vec3{}) continue; // casts no ray
                sources.push_back({{p.x, p.y, p.z},
                                   {static_cast<float>(-n.x), static_cast<float>(-n.y), static_cast<float>(-n.z)},
                                   shape->exit_distances()[v]});
            }
        }
    }

    Found detect(const WorkStep& step) override {
        centred_.clear();
        for (std::uint32_t body = 0; body < step.poses.size(); ++body)
            centred_.push_back(centred_pose(work_.shape(body), step.poses[body]));
        contacts_.clear();
        Found found;
        for (const Pair& pair : step.pairs) {
            cast(pair.first.slot, pair.second.slot, found);
            cast(pair.second.slot, pair.first.slot, found);
        }
        for (const Contact& contact : contacts_) found.depth_sum += static_cast<double>(contact.depth);
        found.contacts = contacts_.size();
        return found;
    }

    std::optional<std::uint64_t> own_memory() const override {
        std::uint64_t bytes = device_.bytes();
        for (const auto& sources : sources_) bytes += sources.size() * sizeof(Source);
        return bytes;
    }

private:
    struct Source {
        float position[3], direction[3], reach;
    };

    void cast(std::uint32_t source, std::uint32_t target, Found& found) {
        const Pose pose = relative_pose(centred_[target], centred_[source]);
        float r[9];
        for (std::size_t i = 0; i < 9; ++i) r[i] = static_cast<float>(pose.rotation[i]);
        const float t[3] = {static_cast<float>(pose.translation.x), static_cast<float>(pose.translation.y),
                            static_cast<float>(pose.translation.z)};
        const ShapeData& shape = work_.shape(target).data();
        const EmbreeScene& scene = *scenes_[work_.body_shape[target]];
        for (const Source& s : sources_[work_.body_shape[source]]) {
            float p[3], d[3];
            for (int i = 0; i < 3; ++i)
                p[i] =
                    ((r[3 * i] * s.position[0] + r[3 * i + 1] * s.position[1]) + r[3 * i + 2] * s.position[2]) + t[i];
            const float *low = shape.header.low, *high = shape.header.high;
            if (p[0] < low[0] || p[0] > high[0] || p[1] < low[1] || p[1] > high[1] || p[2] < low[2] || p[2] > high[2])
                continue;
            for (int i = 0; i < 3; ++i)
                d[i] = (r[3 * i] * s.direction[0] + r[3 * i + 1] * s.direction[1]) + r[3 * i + 2] * s.direction[2];
            ++found.rays;
            RTCRayHit hit;
            if (scene.cast(p, d, s.reach, hit)) add(source, target, p, d, hit);
        }
    }

    /// As a caller wants it: in the world, re-projected on the face's normal.
    void add(std::uint32_t source, std::uint32_t target, const float* p, const float* d, const RTCRayHit& hit) {
        const float n[3] = {hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z};
        const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const auto& r = centred_[target].rotation;
        Contact contact;
        const bool from_a = source < target;
        contact.body_a = {std::min(source, target), 0};
        contact.body_b = {std::max(source, target), 0};
        contact.feature.source = from_a ? Side::a : Side::b;
        (from_a ? contact.feature.index_b : contact.feature.index_a) = hit.hit.primID;
        (from_a ? contact.point_a : contact.point_b) = transform_point(
            centred_[target], {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
        const double sign = from_a ? -1 : 1;
        const auto turned = [&](std::size_t row) {
            const double sum = r[row] * static_cast<double>(n[0]) + r[row + 1] * static_cast<double>(n[1])
                               + r[row + 2] * static_cast<double>(n[2]);
            return static_cast<float>(sign * sum / static_cast<double>(length));
        };
        contact.normal = {turned(0), turned(3), turned(6)};
        contact.ray_length = hit.ray.tfar;
        contact.depth = hit.ray.tfar * (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) / length;
        contacts_.push_back(contact);
    }

    const Work& work_;
    EmbreeDevice device_;
    std::vector<std::unique_ptr<EmbreeScene>> scenes_;
    std::vector<std::vector<Source>> sources_; ///< per shape
    std::vector<Pose> centred_;
    std::vector<Contact> contacts_;
};

} // namespace

Entrant embree() {
    return entrant_of<Embree>("embree", "Embree " RTC_VERSION_STRING " rtcIntersect1, our rule vertex by vertex");
}

} // namespace raycontact::bench
