// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/reference.h>

namespace raycontact::bench {

Reference::Reference(const Work& work, Features features) {
    Settings settings = one_thread(Method::standard, Caster::bvh, features);
    settings.skip_outside = false;
    const auto scene = make_scene(work, settings);
    for (const WorkStep& step : work.steps) {
        place(*scene, step);
        std::vector<Name>& names = names_.emplace_back();
        for (const Contact& c : scene->step(step.pairs))
            names.push_back({c.body_a, c.body_b, c.vertex, c.triangle, c.vertex_body, c.feature});
        rays_.push_back(scene->stats().rays);
    }
}

void Reference::compare(std::size_t step, std::span<const Contact> found, recording::WrongRays& wrong) {
    contacts_.resize(names_[step].size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Name& name = names_[step][i];
        contacts_[i].body_a = name.body_a;
        contacts_[i].body_b = name.body_b;
        contacts_[i].vertex_body = name.vertex_body;
        contacts_[i].feature = name.feature;
        contacts_[i].vertex = name.vertex;
        contacts_[i].triangle = name.triangle;
    }
    wrong.add(found, contacts_);
    wrong.rays_compared += rays_[step];
}

} // namespace raycontact::bench
