// SPDX-License-Identifier: Apache-2.0
// What the lever of lever.obj meets as it turns up about its pin, and how near it comes to the rest.
//   example_lever [ASSEMBLY]
#include <raycontact/clash.h>
#include <raycontact/query.h>

#include <cstdio>
#include <exception>
#include <numbers>

int main(int argc, char** argv) try {
    using namespace raycontact;
    const auto parts = load_parts({argc > 1 ? argv[1] : "docs/examples/lever.obj"});

    // From 0 to 90 degrees about the pin, in three moves. Between two of them a part goes by the screw, here the turn.
    const double degree = std::numbers::pi / 180, step = 30;
    const RigidMotion turn{
        .from = {}, .velocity = {}, .angular_velocity = {0, -step * degree, 0}, .centre = {0, 0, 0.1}};
    std::vector<Pose> moves;
    for (int k = 0; k <= 3; ++k) moves.push_back(pose_at(turn, k));
    const PathClashReport report =
        find_path_clashes(parts, {"lever"}, moves, {.exclude = {{"lever", "pin"}}, .clearance = 0.02});
    for (const PathClash& clash : report.clashes)
        std::printf("%s %s at %.4f degrees, %.4f m apart\n", parts[clash.other].name.c_str(),
                    clash.meet ? "is met" : "is nearest", step * clash.place.time, clash.place.distance);

    // The same of two shapes; the second stands still.
    const auto lever = Shape::make(*parts[2].mesh), hood = Shape::make(*parts[3].mesh);
    const std::vector<Pose> still{parts[3].pose};
    const auto impact = time_of_impact(*lever, moves, *hood, still);
    const std::vector<Pose> begin(moves.begin(), moves.begin() + 2);
    const auto clearance = path_clearance(*lever, begin, *hood, still);
    if (!impact || !clearance) return 1;
    std::printf("lever and hood: met at %.4f degrees; up to 30 degrees at least %.4f m apart\n", step * impact->time,
                clearance->distance);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
