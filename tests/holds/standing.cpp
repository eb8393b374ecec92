// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/model.h>
#include <tests/holds/parts.h>
#include <tests/holds/scenes.h>

namespace raycontact::scenes {

namespace {

constexpr int storeys = 10;

Hold stands(const char* name, Stack stack) {
    Hold hold;
    hold.name = name;
    hold.means = "nothing has moved by more than 3 % of its size";
    hold.stack = std::move(stack);
    hold.drift = 0.03;
    return hold;
}

Hold ring_column() {
    Stack stack{"column of tori", {shape_of(smooth_ring(0.35, 0.15, 24, 12), false)}, {}};
    for (int k = 0; k < storeys; ++k)
        stack.bodies.push_back({0, turned_at({0, 0, 0.15 + 0.3 * k}, {0, 0, 1}, k * 0.3 / 24)});
    return stands("column of tori", std::move(stack));
}

/// What is in a shaft stays in its order.
class InOrder : public Course {
public:
    explicit InOrder(std::size_t walls) : walls_(walls) {}
    int passed(const std::vector<Pose>& poses) const override {
        int count = 0;
        for (std::size_t i = walls_; i < poses.size(); ++i) {
            const Vec3& at = poses[i].translation;
            const bool inside = std::abs(at.x) < 0.6 && std::abs(at.y) < 0.6 && at.z > 0;
            count += !inside || (i > walls_ && at.z < poses[i - 1].translation.z);
        }
        return count;
    }

private:
    std::size_t walls_;
};

// A free column of bunnies has no balance.
Hold bunny_column() {
    Hold hold;
    hold.name = "column of bunnies";
    hold.means = "ten bunnies in a shaft keep their order and come to rest";
    hold.stack = {"column of bunnies", {box_of({0.2, 1.6, 12}), box_of({1.2, 0.2, 12})}, {}};
    hold.stack.shapes.push_back(shape_of(stood_up(scene_model("bunny", 902).mesh), false));
    for (const double side : {-0.7, 0.7}) {
        hold.stack.bodies.push_back({0, at(side, 0, 6), true});
        hold.stack.bodies.push_back({1, at(0, side, 6), true});
    }
    for (int k = 0; k < storeys; ++k) hold.stack.bodies.push_back({2, at(0, 0, 0.55 + 1.05 * k)});
    hold.course = [] { return std::make_unique<InOrder>(4); };
    return hold;
}

Hold arch() {
    constexpr int stones = 11;
    Stack stack{"arch", {}, {}};
    for (std::size_t k = 0; k < stones; ++k) {
        const double from = 0.5 * static_cast<double>(k) / stones, to = 0.5 * static_cast<double>(k + 1) / stones;
        Mesh stone = arch_stone(2.6, 3.4, 1, from, to);
        const Vec3 place = centre(stone);
        stack.shapes.push_back(shape_of(std::move(stone), true));
        stack.bodies.push_back({k, {.translation = place}});
    }
    return stands("arch", std::move(stack));
}

Hold heavy(const char* name, StackShape light, StackShape heavy, double low, double high) {
    Stack stack{name, {std::move(light), std::move(heavy)}, {}};
    stack.bodies.push_back({0, at(0, 0, low)});
    stack.bodies.push_back({1, at(0, 0, high)});
    stack.bodies.back().density *= 100;
    return stands(name, std::move(stack));
}

} // namespace

std::vector<Hold> standing() {
    std::vector<Hold> all;
    all.push_back(stands("column of cubes", column()));
    all.push_back(ring_column());
    all.push_back(bunny_column());
    all.push_back(stands("wall", wall()));
    all.push_back(arch());
    all.push_back(heavy("heavy cube on light", box_of({1, 1, 1}), box_of({1, 1, 1}), 0.5, 1.5));
    const StackShape ring = shape_of(smooth_ring(0.35, 0.15, 24, 12), false);
    all.push_back(heavy("heavy torus on light", ring, ring, 0.15, 0.45));
    return all;
}

} // namespace raycontact::scenes
