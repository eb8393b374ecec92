// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/notes.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace raycontact::bench {

std::string heading(const WorkNote& work) {
    return fmt::format("\n{}: {} steps, {} pair-steps; {}\na pair moves {:.3g} % of its size a step (median; most "
                       "{:.3g} %)\n",
                       work.name, work.steps, work.pair_steps, work.source, 100 * work.pace.median,
                       100 * work.pace.most);
}

nlohmann::ordered_json works_json(std::span<const WorkNote> works) {
    auto list = nlohmann::ordered_json::array();
    for (const WorkNote& w : works)
        list.push_back({{"work", w.name},
                        {"source", w.source},
                        {"steps", w.steps},
                        {"pair_steps", w.pair_steps},
                        {"pace_median", w.pace.median},
                        {"pace_most", w.pace.most}});
    return list;
}

void put_counts(nlohmann::ordered_json& object, const StepStats& s, const recording::WrongRays& w) {
    object["rays"] = s.details.rays;
    object["rays_cast"] = s.details.rays_cast;
    object["walks"] = s.details.walks;
    object["walks_lost"] = s.details.walks_lost;
    object["walk_casts"] = s.details.walk_casts;
    object["predictions"] = s.details.predictions;
    object["pairs_full"] = s.details.pairs_full;
    object["pairs_skipped"] = s.details.pairs_skipped;
    object["pair_bytes"] = s.pair_bytes;
    object["contacts"] = s.contacts;
    object["wrong_rays"] = {
        {"total", w.total()}, {"missed", w.missed}, {"invented", w.invented}, {"other_triangle", w.other_triangle}};
    object["rays_compared"] = w.rays_compared;
    object["contacts_compared"] = w.contacts_compared;
}

} // namespace raycontact::bench
