// SPDX-License-Identifier: Apache-2.0
#include <scenes/peers/work.h>

namespace raycontact::peers {

std::uint64_t Work::pair_steps() const {
    std::uint64_t count = 0;
    for (const WorkStep& step : steps) count += step.pairs.size();
    return count;
}

Settings one_thread(Method method, Caster caster, Features features) {
    Settings settings;
    settings.features = features;
    settings.method = method;
    settings.paper.caster = caster;
    settings.execution.threads = 1;
    return settings;
}

std::unique_ptr<Scene> make_scene(const Work& work, const Settings& settings) {
    auto scene = std::make_unique<Scene>(settings);
    for (const std::uint32_t shape : work.body_shape) scene->add(work.shapes[shape]);
    scene->prepare(); // otherwise it would be done beside the steps that are timed
    return scene;
}

void place(Scene& scene, const WorkStep& step) {
    for (std::uint32_t body = 0; body < step.poses.size(); ++body) scene.set_pose({body, 0}, step.poses[body]);
}

void rest(Scene& scene, const WorkStep& first) {
    place(scene, first);
    scene.find_contacts(first.pairs);
    scene.set_settings(Settings(scene.settings())); // forgets
}

void find_pairs(Work& work) {
    const auto scene = make_scene(work, one_thread(Method::standard));
    for (WorkStep& step : work.steps) {
        place(*scene, step);
        scene->find_contacts();
        step.pairs.assign(scene->pairs().begin(), scene->pairs().end());
    }
}

} // namespace raycontact::peers
