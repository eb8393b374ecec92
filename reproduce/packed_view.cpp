// SPDX-License-Identifier: Apache-2.0
#include <reproduce/packed_view.h>

#include <view/blob.h>
#include <view/motion.h>
#include <view/view.h>

#include <algorithm>

namespace raycontact::reproduce {

namespace {

// Two views share a page with all figures: about half of what `raycontact view` keeps.
constexpr std::uint32_t layer_steps = 30, most_poses = 400'000;

std::string make(const Workshop& shop, const SimulationOptions& options, double cost, const Tick& tick) {
    recording::Reader reader(shop.recording(options, [](double) {}));
    view::ViewOptions how;
    how.settings = as_in_the_paper(Method::predictive, shop.plan().constants);
    how.layer_every = std::max(reader.steps() / layer_steps, 1u);
    how.stride = view::stride_for(static_cast<std::uint32_t>(reader.bodies().size()), reader.steps(), most_poses);
    const double share = cost / work_of(reader, how);
    how.progress = [&](std::uint32_t) { tick(share); };
    const std::string html = make_view(reader, how).html;
    const view::Bytes bytes(html.begin(), html.end());
    return view::blob(bytes);
}

} // namespace

Part view_part(const Workshop& shop, const std::string& scene) {
    const SimulationOptions options = shop.base(scene);
    const double cost = 0.5 * Workshop::cost(options);
    Json key = shop.key("view", options);
    key["settings"]["drawn"] = to_json(as_in_the_paper(Method::predictive, shop.plan().constants));
    return {"view-" + scene, key, cost,
            [&shop, options, cost](const Tick& tick) { return make(shop, options, cost, tick); }};
}

} // namespace raycontact::reproduce
