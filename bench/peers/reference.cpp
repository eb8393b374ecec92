// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/reference.h>

namespace raycontact::bench {

Reference::Reference(const Work& work, Features features) {
    Settings settings = one_thread(Method::standard, Caster::bvh, features);
    settings.paper.skip_outside = false;
    const auto scene = make_scene(work, settings);
    for (const WorkStep& step : work.steps) {
        place(*scene, step);
        std::vector<Name>& names = names_.emplace_back();
        for (const Contact& c : scene->find_contacts(step.pairs)) names.push_back({c.body_a, c.body_b, c.feature});
        rays_.push_back(scene->stats().details.rays);
    }
}

void Reference::compare(std::size_t step, std::span<const Contact> found, recording::WrongRays& wrong) {
    contacts_.resize(names_[step].size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Name& name = names_[step][i];
        contacts_[i].body_a = name.body_a;
        contacts_[i].body_b = name.body_b;
        contacts_[i].feature = name.feature;
    }
    wrong.add(found, contacts_);
    wrong.rays_compared += rays_[step];
}

} // namespace raycontact::bench
