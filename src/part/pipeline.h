// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/gather.h"
#include "contacts/local_contacts.h"
#include "rays/certified.h"
#include "rays/coherent.h"
#include "rays/standard.h"

#include <raycontact/scene.h>

namespace raycontact {

/// From pairs to contacts in the targets' frames: finds the rays by a method, casts them and gathers their contacts.
/// Its arrays stay between steps, so that after warm-up a step allocates nothing.
class Pipeline {
public:
    /// Starts a step.
    void begin(const Update& update);
    /// The contacts of the step that begin() started with the same update. LocalContact::pair is the directed index in
    /// update.pairs. Valid until the next begin().
    std::span<const kernels::LocalContact> end(const Update& update);

    /// As Part's.
    std::vector<std::byte> take_out(const Update& last, std::span<const SlotPair> pairs);
    void put_in(const Update& last, std::span<const std::byte> bytes);

    void list_kept_rays(const Update& last, std::vector<KeptRay>& rays);

    /// Adds what the last step did.
    void count(const Update& last, StepStats& stats) const;
    /// After all of a step, with its update: frees memory that it hardly used. What end() returned is gone.
    void give_back(const Update& last);
    /// Forgets what the methods kept.
    void forget();

private:
    StandardRays standard_;
    CertifiedRays certified_;
    CoherentRays coherent_;
    RayBatch batch_;
    Gather gather_;
    LocalContacts local_;
};

/// Whether the method, or what is asked of edges, needs the motion of bodies on this device.
bool needs_motion(const Settings& settings, const DeviceTraits& traits);

} // namespace raycontact
