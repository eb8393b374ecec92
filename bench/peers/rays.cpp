// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/embree_scene.h>
#include <bench/peers/entrants.h>

#include "device/device.h"
#include "executor/float_environment.h"
#include "pairs/directed_pairs.h"
#include "pairs/motion.h"
#include "rays/standard.h"

namespace raycontact::bench {

namespace {

/// The rays of each step, found by us and not timed; what is timed is only casting them, all of the rule's.
class RayPeer : public Peer {
public:
    explicit RayPeer(const Work& work) : opened_(open_device("cpu", 1)), shapes_(*opened_.device) {
        for (const auto& shape : work.shapes) {
            shape->prepare(); // for the rays that the grids leave
            shapes_.add(shape);
        }
        for (std::uint32_t body = 0; body < work.body_shape.size(); ++body) {
            PlacedBody& placed = bodies_.emplace_back();
            placed.shape = &work.shape(body);
            placed.shape_index = shapes_.index_of(placed.shape);
        }
    }

    void prepare(const WorkStep& step) override {
        const FloatEnvironment environment;
        for (std::size_t body = 0; body < bodies_.size(); ++body) {
            PlacedBody& placed = bodies_[body];
            placed.pose = step.poses[body];
            placed.centred = centred_pose(*placed.shape, placed.pose);
        }
        moved_.forget(); // every pose is set
        pairs_.clear();
        for (const auto& [a, b] : step.pairs) pairs_.open({a.slot, b.slot});
        find(false);
    }

protected:
    Update update() {
        return {*opened_.device, *opened_.executor, shapes_, bodies_, moved_, pairs_, {}, {}, motion_, settings_};
    }

    // grid: those alone that the grids of the shapes leave. They are cast, too.
    void find(bool grid) {
        settings_.paper.skip_outside = grid;
        standard_.begin(update(), batch_);
        for (;;) {
            batch_.totals.read(*opened_.device, batch_.sums);
            if (standard_.had_room(*opened_.device, batch_)) break;
            standard_.cast(update(), batch_);
        }
    }
    std::size_t ray_count() const { return batch_.sums[RayBatch::ray_sum].results; }

    OpenDevice opened_;
    ShapeStore shapes_;
    std::vector<PlacedBody> bodies_;
    PairSlots pairs_;
    SlotChanges moved_;
    Motion motion_;
    Settings settings_;
    StandardRays standard_;
    RayBatch batch_;
};

class OurRays : public RayPeer {
public:
    using RayPeer::RayPeer;

    Found detect(const WorkStep&) override {
        const FloatEnvironment environment;
        cast_in_full(update(), batch_);
        return found();
    }

protected:
    Found found() {
        host_.resize(ray_count());
        batch_.hits.read(*opened_.device, host_);
        Found found;
        found.rays = host_.size();
        for (const kernels::Hit& hit : host_) {
            if (hit.triangle == NONE) continue;
            ++found.contacts;
            found.depth_sum += static_cast<double>(hit.distance);
        }
        return found;
    }

private:
    std::vector<kernels::Hit> host_;
};

/// The same rays as the library answers them: vertices known to be outside cast none. Finding the vertices is timed
/// too.
class OurSparedRays : public OurRays {
public:
    using OurRays::OurRays;

    Found detect(const WorkStep&) override {
        const FloatEnvironment environment;
        find(true);
        Found of_all = found();
        of_all.rays = batch_.sums[RayBatch::ray_sum].sums[1];
        return of_all;
    }
};

class EmbreeRays : public RayPeer {
public:
    explicit EmbreeRays(const Work& work) : RayPeer(work), scenes_(work.shapes.size()) {
        for (const auto& shape : work.shapes)
            scenes_[shapes_.index_of(shape.get())] = std::make_unique<EmbreeScene>(device_, *shape);
    }

    void prepare(const WorkStep& step) override {
        RayPeer::prepare(step);
        rays_.resize(ray_count());
        batch_.rays.read(*opened_.device, rays_);
        ordered_.resize(batch_.pairs->size());
        batch_.pairs->read(*opened_.device, ordered_);
    }

    Found detect(const WorkStep&) override {
        Found found;
        found.rays = rays_.size();
        for (const kernels::Ray& ray : rays_) {
            // The vertex's way into the target's frame is part of the work, as it is of ours.
            const kernels::prototype::SourceRay source =
                kernels::prototype::source_ray(&ordered_[ray.pair], shapes_.headers().data(), nullptr, ray.vertex_lane);
            RTCRayHit hit;
            if (!scenes_[ordered_[ray.pair].target]->cast(source.position, source.direction, source.reach, hit))
                continue;
            ++found.contacts;
            found.depth_sum += static_cast<double>(hit.ray.tfar);
        }
        return found;
    }

    std::optional<std::uint64_t> own_memory() const override { return device_.bytes(); }

private:
    EmbreeDevice device_;
    std::vector<std::unique_ptr<EmbreeScene>> scenes_; ///< by index in the store
    std::vector<kernels::Ray> rays_;
    std::vector<kernels::DirectedPair> ordered_;
};

} // namespace

Entrant rays_of_ours() {
    return entrant_of<OurRays>("rays", "RayContact, casting alone", true);
}

Entrant spared_rays_of_ours() {
    return entrant_of<OurSparedRays>("grid-rays",
                                     "RayContact, finding the vertices and casting what the outside grid leaves", true);
}

Entrant rays_of_embree() {
    return entrant_of<EmbreeRays>("embree-rays", "Embree " RTC_VERSION_STRING " rtcIntersect1, casting alone", true);
}

} // namespace raycontact::bench
