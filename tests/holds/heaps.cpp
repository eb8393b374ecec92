// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/model.h>
#include <scenes/random.h>
#include <tests/holds/parts.h>
#include <tests/holds/scenes.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

namespace {

/// What lies in a vessel does not come out through its walls.
class Inside : public Course {
public:
    using Test = bool (*)(const Vec3& at);
    Inside(std::size_t first, Test is_outside) : first_(first), is_outside_(is_outside) {}
    int passed(const std::vector<Pose>& poses) const override {
        int count = 0;
        for (std::size_t i = first_; i < poses.size(); ++i) count += is_outside_(poses[i].translation);
        return count;
    }

private:
    std::size_t first_;
    Test is_outside_;
};

/// Of shape 1, turned as they may.
void drop(Stack& stack, int across, int layers, double apart, double low) {
    Random random(5);
    double reach = 0;
    for (const Vec3& v : stack.shapes[1].mesh.vertices)
        reach = std::max(reach, std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z));
    for (int layer = 0; layer < layers; ++layer)
        for (int i = 0; i < across; ++i)
            for (int k = 0; k < across; ++k) {
                // Those that have no room to turn in are tilted a little.
                const auto q = apart < 2 * reach ? random.tilt(0.3) : random.rotation();
                stack.bodies.push_back({1, pose_from_quaternion({apart * (i - (across - 1) / 2.0),
                                                                 apart * (k - (across - 1) / 2.0), low + apart * layer},
                                                                q[0], q[1], q[2], q[3])});
            }
}

Hold heap(const char* name, const char* means) {
    Hold hold;
    hold.name = name;
    hold.means = means;
    return hold;
}

Hold bowl() {
    Hold hold = heap("bowl of bunnies", "16 bunnies lie in it at rest");
    Mesh mesh = round_bowl(2.4, 2.5, 48);
    Vec3 place = centre(mesh);
    place.z += 2.5;
    hold.stack = {"bowl", {shape_of(std::move(mesh), false)}, {}};
    hold.stack.shapes.push_back(shape_of(scene_model("bunny", 902).mesh, false));
    hold.stack.bodies.push_back({0, {.translation = place}, true});
    drop(hold.stack, 2, 4, 1.4, 1.5);
    hold.course = [] {
        return std::make_unique<Inside>(1, [](const Vec3& p) {
            return p.z < 2.5 && std::sqrt(p.x * p.x + p.y * p.y + (p.z - 2.5) * (p.z - 2.5)) > 2.45;
        });
    };
    return hold;
}

Hold bin() {
    Hold hold = heap("bin of bunnies", "27 bunnies lie in it at rest");
    hold.stack = {"bin", {tray_of({4.2, 4.2, 4.2}, 0.1)}, {}};
    hold.stack.shapes.push_back(shape_of(scene_model("bunny", 902).mesh, false));
    double low = 0;
    for (const Vec3& v : hold.stack.shapes[0].mesh.vertices) low = std::min(low, v.z);
    hold.stack.bodies.push_back({0, at(0, 0, -low), true});
    drop(hold.stack, 3, 3, 1.25, 0.9);
    hold.course = [] {
        return std::make_unique<Inside>(
            1, [](const Vec3& p) { return p.z < 0.1 || (p.z < 4 && std::max(std::abs(p.x), std::abs(p.y)) > 2.05); });
    };
    return hold;
}

Hold thousand_tori() {
    Hold hold = heap("1 000 tori", "poured into a box, they lie in it at rest");
    hold.stack = {"1 000 tori", {tray_of({4.2, 4.2, 4}, 0.1)}, {}};
    hold.stack.shapes.push_back(shape_of(smooth_ring(0.14, 0.06, 16, 8), false));
    double low = 0;
    for (const Vec3& v : hold.stack.shapes[0].mesh.vertices) low = std::min(low, v.z);
    hold.stack.bodies.push_back({0, at(0, 0, -low), true});
    drop(hold.stack, 8, 16, 0.47, 0.4);
    hold.stack.bodies.resize(1001);
    hold.size = 0.4;
    hold.slop = 0.0004;
    hold.sample = 60;
    hold.course = [] {
        return std::make_unique<Inside>(
            1, [](const Vec3& p) { return p.z < 0.1 || (p.z < 4 && std::max(std::abs(p.x), std::abs(p.y)) > 2.05); });
    };
    return hold;
}

} // namespace

std::vector<Hold> heaps() {
    return {bowl(), bin(), thousand_tori()};
}

} // namespace raycontact::scenes
