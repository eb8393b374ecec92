// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/peer.h>

#include <raycontact/settings.h>

namespace raycontact::bench {

namespace {

class Ours : public Peer {
public:
    Ours(const Work& work, Caster caster) : scene_(make_scene(work, caster)) {
        for (const auto& shape : work.shapes) shapes_ += shape->memory_bytes();
    }

    Found detect(const WorkStep& step) override {
        for (BodyId body = 0; body < step.poses.size(); ++body) scene_->set_pose(body, step.poses[body]);
        Found found;
        for (const Contact& contact : scene_->step(step.pairs)) found.depth_sum += static_cast<double>(contact.depth);
        found.rays = scene_->stats().rays;
        found.contacts = scene_->contacts().size();
        return found;
    }

    void note(std::uint32_t step) override {
        all_.add(step, scene_->contacts());
        ContactHash one;
        one.add(step, scene_->contacts());
        each_.push_back(one.hex());
    }
    std::string hash() const override { return all_.hex(); }
    std::vector<std::string> step_hashes() const override { return each_; }
    std::uint64_t shared_memory() const override { return shapes_; }

private:
    std::unique_ptr<Scene> scene_;
    std::uint64_t shapes_ = 0;
    ContactHash all_;
    std::vector<std::string> each_;
};

} // namespace

Entrant ours(bool bvh) {
    const Caster caster = bvh ? Caster::bvh : Caster::basic;
    Entrant entrant;
    entrant.name = bvh ? "bvh" : "basic";
    entrant.what = bvh ? "RayContact standard bvh" : "RayContact standard basic";
    entrant.every = bvh ? 1 : 10;
    entrant.make = [caster](const Work& work) { return std::make_unique<Ours>(work, caster); };
    return entrant;
}

} // namespace raycontact::bench
