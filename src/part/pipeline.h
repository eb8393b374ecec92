// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/results.h"
#include "edges/inside_search.h"
#include "pairs/by_pair.h"
#include "pairs/found_pairs.h"
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
    /// Ends the step that begin() started with the same update. Returns it with the pairs that the answers are of:
    /// those asked, or of a device that answers for all, those of which it found something. What follows is valid until
    /// the next begin().
    Update end(const Update& update);
    /// The contacts of vertices; LocalContact::pair is the directed index in the pairs of end().
    const ByPair<kernels::LocalContact>& contacts() const { return local_; }
    /// The speculative contacts of vertices.
    const SpeculativeVertices& speculative() const { return speculative_; }
    /// The pairs whose edges may cross faces, or have speculative contacts, or that may be inside one another, in
    /// order; none without edges and speculative contacts.
    std::span<const AskedPair> asked() const { return asked_; }

    /// As Part's.
    std::vector<std::byte> export_state(const Update& last, const PairList& pairs);
    void import_state(const Update& last, const PairList& pairs, std::span<const std::byte> bytes);

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
    Update list_pairs(const Update& asked);
    void find_inside(const Update& update);
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
    InsideSearch inside_;
    std::vector<float> margins_; ///< of speculative contacts, by directed pair of the device
    SlotChanges::Seen margins_seen_ = 0;
    Array<float> device_margins_;
    Results<kernels::LocalContact> found_; ///< in the order of their rays
    FoundPairs pairs_found_;               ///< by a device that answers by slot
    ByPair<kernels::LocalContact> local_;
    ByPair<NearEdge> near_, near_points_;
    bool casts_edges_ = false, casts_points_ = false;
    SpeculativeVertices speculative_;
    std::vector<AskedPair> asked_;
    std::vector<std::vector<AskedPair>> asked_slices_; ///< of slices of the pairs
};

/// How the method answers on this device: for the pairs that are asked about, which may be those alone of which
/// something may have changed; for those, but all must be asked about in every step; or for all, whatever is asked.
enum class Answers : std::uint8_t { some, asked, all };
Answers answers(const Settings& settings, const DeviceTraits& traits);
/// Whether the method needs the motion of bodies on this device.
bool needs_motion(const Settings& settings, const DeviceTraits& traits);

} // namespace raycontact
