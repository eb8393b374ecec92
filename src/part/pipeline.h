// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/results.h"
#include "pairs/by_pair.h"
#include "pairs/near_edges.h"
#include "rays/certified.h"
#include "rays/coherent.h"
#include "rays/near_rays.h"
#include "rays/standard.h"
#include "speculative/speculative_vertices.h"

#include <raycontact/scene.h>

namespace raycontact {

/// From pairs to contacts in the targets' frames: finds the rays by a method, casts them and gathers their contacts.
/// Its arrays stay between steps, so that after warm-up a step allocates nothing.
class Pipeline {
public:
    /// Starts a step.
    void begin(const Update& update);
    /// Ends the step that begin() started with the same update. What follows is valid until the next begin().
    void end(const Update& update);
    /// The contacts of vertices; LocalContact::pair is the directed index in update.pairs.
    const ByPair<kernels::LocalContact>& contacts() const { return local_; }
    /// The speculative contacts of vertices.
    const SpeculativeVertices& speculative() const { return speculative_; }
    /// The pairs whose edges may cross faces, or have speculative contacts, or that may be inside one another, in
    /// order; none without edges and speculative contacts.
    std::span<const AskedPair> asked() const { return asked_; }

    /// Whether the i-th pair of the step has what it had in the last one, which was not found again.
    bool rests(const Update& update, std::size_t i) { return update.may_rest && certified_.rests(i); }

    /// As Part's.
    std::vector<std::byte> export_state(const Update& last, std::span<const SlotPair> pairs);
    void import_state(const Update& last, std::span<const std::byte> bytes);

    void list_kept_rays(const Update& last, std::vector<KeptRay>& rays);

    /// Adds what the last step did.
    void count(const Update& last, StepStats& stats) const;
    /// After all of a step: frees what the next makes anew. What the step found is gone.
    void trim();
    /// Forgets what the methods kept.
    void forget();

private:
    void gather(const Update& update);
    bool read(const Update& update);
    bool all_rays_had_room(const Update& update);
    void cast_again(const Update& update);
    void set_margins(const Update& update);
    void cast_near(const Update& update, NearRays& rays);
    void find_speculative(const Update& update);
    const DevicePairs& pairs_of(const Update& update) const;
    void list_asked(const Update& update);
    template <class Ask>
    void list(const Update& update, Ask&& ask);

    StandardRays standard_;
    CertifiedRays certified_;
    CoherentRays coherent_;
    DevicePairs pairs_; ///< all, where the method places only some
    RayBatch batch_;
    NearRays edges_{BlockSearch::Sources::edges}, points_{BlockSearch::Sources::points};
    std::vector<float> margins_; ///< of speculative contacts, by directed pair of the device
    Array<float> device_margins_;
    Results<kernels::LocalContact> found_; ///< in the order of their rays
    ByPair<kernels::LocalContact> local_;
    ByPair<NearEdge> near_, near_points_;
    bool casts_edges_ = false, casts_points_ = false;
    SpeculativeVertices speculative_;
    std::vector<AskedPair> asked_;
    std::vector<std::vector<AskedPair>> asked_slices_; ///< of slices of the pairs
};

/// Whether the method lets pairs rest (Update::may_rest) on this device.
bool can_rest(const Settings& settings, const DeviceTraits& traits);
/// Whether the method needs the motion of bodies on this device.
bool needs_motion(const Settings& settings, const DeviceTraits& traits);

} // namespace raycontact
