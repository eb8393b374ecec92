// SPDX-License-Identifier: Apache-2.0
#include <scenes/peers/peer.h>

#include <raycontact/settings.h>

namespace raycontact::peers {

namespace {

class Ours : public Peer {
public:
    Ours(const Work& work, const Settings& settings) : scene_(make_scene(work, settings)) {
        for (const auto& shape : work.shapes) shapes_ += shape->memory_bytes();
    }

    void restart(const WorkStep& first) override { rest(*scene_, first); }

    Found detect(const WorkStep& step) override {
        place(*scene_, step);
        Found found;
        for (const Contact& contact : scene_->find_contacts(step.pairs))
            found.depth_sum += static_cast<double>(contact.depth);
        found.rays = scene_->stats().details.rays;
        found.contacts = scene_->contacts().size();
        return found;
    }

    const Scene* scene() const override { return scene_.get(); }
    std::uint64_t shared_memory() const override { return shapes_; }

private:
    std::unique_ptr<Scene> scene_;
    std::uint64_t shapes_ = 0;
};

} // namespace

Entrant ours(std::string name, Method method, Caster caster, Features features) {
    const Settings settings = one_thread(method, caster, features);
    Entrant entrant;
    entrant.name = std::move(name);
    entrant.what = "RayContact " + std::string(to_string(method)) + " " + std::string(to_string(caster))
                   + (features == Features::edges ? ", edges" : "");
    entrant.exact = (method == Method::standard || method == Method::certified) && features == Features::vertices;
    entrant.all_steps = method != Method::standard || caster == Caster::bvh;
    entrant.every = 10;
    entrant.make = [settings](const Work& work) { return std::make_unique<Ours>(work, settings); };
    return entrant;
}

} // namespace raycontact::peers
