// SPDX-License-Identifier: Apache-2.0
#include "bench/micro/coherence.h"

#include "bench/micro/copy.h"
#include "device/cpu/device.h"
#include "pairs/rounding.h"
#include "rays/held.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace raycontact::bench {

namespace {

constexpr double look_ahead = 0.02;      // of the box diagonal; what `predictive` does at a threshold of one percent
constexpr kernels::uint iterations = 16; // Settings::max_iterations

} // namespace

Coherence::Coherence(Executor& executor, std::string_view instruction_set, const Batch& batch)
    : device_(cpu::open(executor, instruction_set)), store_(*device_) {
    store_.add(batch.shape);
    const auto ahead = static_cast<float>(look_ahead * batch.shape->data().diagonal);
    const auto margin = [&](std::size_t i) {
        return static_cast<float>(rounding_margin(batch.bodies[i], batch.bodies[i ^ 1]));
    };
    std::vector<kernels::OrderedPair> wide = batch.ordered;
    std::vector<float> margins, reaches;
    for (std::size_t i = 0; i < wide.size(); ++i) { // two ordered pairs for each pair, two bodies for each pair
        widen(wide[i], ahead);
        margins.push_back(margin(i));
        reaches.push_back(ahead + margins.back());
    }
    pairs_.write(*device_, batch.ordered);
    moved_.write(*device_, batch.moved);
    wide_.write(*device_, wide);
    margins_.write(*device_, margins);
    reaches_.write(*device_, reaches);
    cullings_.write(*device_, std::vector<float>(wide.size(), ahead));

    pair_clusters_.resize(*device_, wide.size());
    small_.resize(*device_, wide.size());
    clears_.resize(*device_, wide_.size());
    count_near_clusters();
    clusters_.resize(*device_, scan_.run(*device_, pair_clusters_, cluster_firsts_));
    write_near_clusters();
    const std::vector<kernels::Cluster> clusters = copy_of(*device_, clusters_);
    watch_clusters_.write(*device_, clusters);

    block_inside_.resize(*device_, clusters.size());
    block_rays_.resize(*device_, clusters.size());
    find_near_rays();
    hits_.resize(*device_, rays_.size());
    nexts_.resize(*device_, rays_.size());
    hows_.resize(*device_, rays_.size());
    cast_near_rays(Caster::bvh);
    basic_hits_.resize(*device_, basic_rays());
    basic_nexts_.resize(*device_, basic_rays());
    basic_hows_.resize(*device_, basic_rays());
    cast_near_rays(Caster::basic);

    const std::vector<kernels::Ray> rays = copy_of(*device_, rays_);
    const std::vector<kernels::uint> nexts = copy_of(*device_, nexts_);
    std::vector<kernels::Ray> walk_rays;
    std::vector<kernels::uint> walk_starts;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (nexts[i] == NONE) continue;
        walk_rays.push_back(rays[i]);
        walk_starts.push_back(nexts[i]);
    }
    walk_rays_.write(*device_, walk_rays);
    walk_starts_.write(*device_, walk_starts);
    walk_hits_.resize(*device_, walk_rays.size());
    walk_nexts_.resize(*device_, walk_rays.size());
    walk_hows_.resize(*device_, walk_rays.size());
    walk();

    std::vector<kernels::Segment> segments;
    const std::vector<kernels::uint> firsts = copy_of(*device_, cluster_firsts_),
                                     counts = copy_of(*device_, pair_clusters_);
    for (kernels::uint p = 0; p < wide.size(); ++p)
        for (kernels::uint done = 0; done < counts[p]; done += SEGMENT_WATCHES)
            segments.push_back(
                {p, firsts[p] + done, std::min(SEGMENT_WATCHES, counts[p] - done), UNBOUNDED, 0, margins[p], 0});
    segments_.write(*device_, segments);
    watches_.resize(*device_, clusters.size());
    looks_.resize(*device_, segments.size());
    segment_rays_.resize(*device_, segments.size());
    begin_watches();
    find_watch_rays();

    std::vector<kernels::Holder> holders(wide.size());
    for (std::size_t p = 0; p < wide.size(); ++p)
        holders[p] = {0,
                      0,
                      0,
                      margins[p],
                      static_cast<float>(HeldRays::tube_radius(batch.shape->data().diagonal, batch.shape->data())),
                      batch.shape->data().header.caps_pay};
    seekers_.write(*device_, holders);
    const std::vector<kernels::Ray> watched = copy_of(*device_, watch_rays_);
    for (std::size_t i = watched.size(); i-- > 0;) {
        holders[watched[i].pair].first = holders[watched[i].pair].now_first = static_cast<kernels::uint>(i);
        ++holders[watched[i].pair].count;
    }
    holders_.write(*device_, holders);
    held_.resize(*device_, watched.size());
    held_again_.resize(*device_, watched.size());
    held_hits_.resize(*device_, watched.size());
    held_casts_.resize(*device_, watched.size());
    seek_tubes();
    if (walks() == 0 || watch_rays() == 0) throw std::logic_error("the batch " + batch.name + " has nothing to follow");
}

void Coherence::count_near_clusters() {
    const auto& shapes = store_.arrays();
    launch<KernelId::count_near_clusters>(*device_, wide_.size(), wide_, reaches_, shapes.headers, shapes.clusters,
                                          shapes.clearances, pair_clusters_, clears_, small_);
}

void Coherence::write_near_clusters() {
    const auto& shapes = store_.arrays();
    launch<KernelId::write_near_clusters>(*device_, wide_.size(), wide_, reaches_, shapes.headers, shapes.clusters,
                                          shapes.clearances, small_, cluster_firsts_, clusters_);
}

void Coherence::count_near_rays() {
    const auto& shapes = store_.arrays();
    launch<KernelId::count_near_rays>(*device_, clusters_.size(), wide_, reaches_, margins_, shapes.headers,
                                      shapes.vertex_blocks, shapes.clearances, clusters_, block_inside_, block_rays_);
}

void Coherence::write_near_rays() {
    launch<KernelId::write_near_rays>(*device_, clusters_.size(), clusters_, ray_firsts_, rays_, starts_);
}

void Coherence::follow(Caster caster, std::size_t count, const Array<kernels::OrderedPair>& pairs,
                       const Array<kernels::Ray>& rays, const Array<kernels::uint>& starts, Array<kernels::Hit>& hits,
                       Array<kernels::uint>& nexts, Array<kernels::uint>& hows) {
    const auto& shapes = store_.arrays();
    constexpr kernels::uint predictive = 1, cast_lost = 1;
    if (caster == Caster::basic)
        launch<KernelId::follow_rays_basic>(*device_, count, iterations, predictive, cast_lost, pairs, cullings_,
                                            shapes.headers, shapes.vertex_blocks, shapes.nodes, shapes.triangle_blocks,
                                            shapes.faces, shapes.face_normals, rays, starts, hits, nexts, hows);
    else
        launch<KernelId::follow_rays_bvh>(*device_, count, iterations, predictive, cast_lost, pairs, cullings_,
                                          shapes.headers, shapes.vertex_blocks, shapes.nodes, shapes.triangle_blocks,
                                          shapes.faces, shapes.face_normals, rays, starts, hits, nexts, hows);
}

void Coherence::cast_near_rays(Caster caster) {
    if (caster == Caster::basic)
        follow(caster, basic_rays(), pairs_, rays_, starts_, basic_hits_, basic_nexts_, basic_hows_);
    else
        follow(caster, near_rays(), pairs_, rays_, starts_, hits_, nexts_, hows_);
}

void Coherence::walk() {
    follow(Caster::bvh, walks(), moved_, walk_rays_, walk_starts_, walk_hits_, walk_nexts_, walk_hows_);
}

std::size_t Coherence::basic_rays() const {
    return std::min<std::size_t>(rays_.size(), 512);
}

void Coherence::begin_watches() {
    const auto& shapes = store_.arrays();
    // Lists one after the other, as the clusters: where a pair's begins is the same in both.
    launch<KernelId::begin_watches>(*device_, watch_clusters_.size(), wide_, shapes.headers, shapes.clusters,
                                    shapes.clearances, margins_, watch_clusters_, cluster_firsts_, cluster_firsts_,
                                    watches_);
}

void Coherence::look_at_watches() {
    const auto& shapes = store_.arrays();
    launch<KernelId::look_at_watches>(*device_, segments_.size(), pairs_, shapes.headers, shapes.vertex_blocks,
                                      shapes.clearances, segments_, watches_, looks_, segment_rays_);
}

// None is repeated, so that any rays will do as those of the last step.
void Coherence::write_watch_rays() {
    launch<KernelId::write_watch_rays>(*device_, segments_.size(), segments_, watches_, looks_, rays_, segment_firsts_,
                                       watch_rays_);
}

void Coherence::hold(const Array<kernels::Holder>& holders, const Array<kernels::Held>& before,
                     Array<kernels::Held>& after) {
    const auto& shapes = store_.arrays();
    launch<KernelId::hold_rays>(*device_, watch_rays_.size(), pairs_, holders, shapes.headers, shapes.vertex_blocks,
                                shapes.nodes, shapes.triangle_blocks, shapes.faces, shapes.face_normals, watch_rays_,
                                before, after, held_hits_, held_casts_);
}

void Coherence::seek_tubes() {
    hold(seekers_, held_again_, held_);
}

void Coherence::decide_held() {
    hold(holders_, held_, held_again_);
}

void Coherence::find_near_rays() {
    count_near_rays();
    rays_.resize(*device_, scan_.run(*device_, block_rays_, ray_firsts_));
    starts_.resize(*device_, rays_.size());
    write_near_rays();
}

void Coherence::find_watch_rays() {
    look_at_watches();
    watch_rays_.resize(*device_, scan_.run(*device_, segment_rays_, segment_firsts_));
    write_watch_rays();
}

} // namespace raycontact::bench
