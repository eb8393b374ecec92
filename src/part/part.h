// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/gather.h"
#include "contacts/local_contacts.h"
#include "device/counting.h"
#include "rays/certified.h"
#include "rays/coherent.h"
#include "rays/standard.h"

#include <raycontact/scene.h>

namespace raycontact {

/// What one device does for the pairs that are its own: it keeps the shapes, finds the rays by a method, casts them and
/// gathers their contacts. It knows bodies by their slots, and no other part. Its arrays stay between steps, so that
/// after warm-up a step allocates nothing.
class Part {
public:
    explicit Part(OpenDevice opened);

    Executor& executor() { return *executor_; }
    ShapeStore& shapes() { return shapes_; }

    /// Starts a step. bodies: of the scene, by slot. pairs: the part's, sorted, each once. All stay valid until end().
    void begin(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, const Settings& settings);
    /// The contacts of the step, by pair: LocalContact::pair is the directed index in `pairs`. Valid until begin().
    std::span<const kernels::LocalContact> end();

    /// The state kept for some pairs of the last step, for another part to go on with as this part would have. bodies
    /// as in the last step. Empty if the contacts do not depend on that state.
    std::vector<std::byte> take_out(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs);
    /// Adds such state. Call it before the begin() that first has these pairs, with the same bodies.
    void put_in(std::span<const PlacedBody> bodies, std::span<const std::byte> bytes);

    /// Adds what the last step did.
    void count(StepStats& stats) const;
    const DeviceWork& work() const { return work_; }

    /// Forgets what the methods kept.
    void forget();

private:
    enum class Finds : std::uint8_t { standard, certified, coherent };
    Finds finds(const Settings& settings) const;
    Update update() const;

    std::unique_ptr<Executor> executor_;
    std::unique_ptr<CountingDevice> device_;
    ShapeStore shapes_;
    Motion motion_;
    StandardRays standard_;
    CertifiedRays certified_;
    CoherentRays coherent_;
    RayBatch batch_;
    Gather gather_;
    LocalContacts local_;
    DeviceWork work_;

    std::span<const PlacedBody> bodies_; ///< of the step, as what follows
    std::span<const SlotPair> pairs_;
    const Settings* settings_ = nullptr;
};

} // namespace raycontact
