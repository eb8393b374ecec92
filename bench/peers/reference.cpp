// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/reference.h>

namespace raycontact::bench {

Reference::Reference(const Work& work) {
    Settings settings = one_thread(Method::standard);
    settings.skip_outside = false;
    const auto scene = make_scene(work, settings);
    for (const WorkStep& step : work.steps) {
        place(*scene, step);
        std::vector<Name>& names = names_.emplace_back();
        for (const Contact& c : scene->step(step.pairs))
            names.push_back({c.body_a, c.body_b, static_cast<std::uint32_t>(c.vertex_body), c.vertex, c.triangle});
        rays_.push_back(scene->stats().rays);
    }
}

void Reference::compare(std::size_t step, std::span<const Contact> found, recording::WrongRays& wrong) {
    contacts_.resize(names_[step].size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Name& name = names_[step][i];
        contacts_[i].body_a = name[0];
        contacts_[i].body_b = name[1];
        contacts_[i].vertex_body = static_cast<VertexBody>(name[2]);
        contacts_[i].vertex = name[3];
        contacts_[i].triangle = name[4];
    }
    wrong.add(found, contacts_);
    wrong.rays_compared += rays_[step];
}

} // namespace raycontact::bench
