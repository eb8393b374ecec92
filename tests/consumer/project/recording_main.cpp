// SPDX-License-Identifier: Apache-2.0
// A user records the motion of a scene of their own: one cube passes over another.
#include <raycontact/recorder.h>

#include <cstdio>

int main(int, char** arguments) {
    raycontact::Mesh cube;
    cube.name = "cube";
    cube.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    cube.triangles = {{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                      {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    const auto shape = raycontact::Shape::make(cube);

    raycontact::Scene scene;
    scene.add(shape);
    const auto moving = scene.add(shape);
    raycontact::RecorderOptions options;
    options.dt = 0.01;
    raycontact::Recorder recorder(arguments[1], scene, options);
    for (int step = 0; step < 100; ++step) {
        scene.set_pose(moving, {.translation = {-1.0 + 0.02 * step, 0.3, 0.9}});
        scene.find_contacts();
        recorder.record();
    }
    recorder.finish();
    std::printf("%u steps, hash %s\n", recorder.steps(), recorder.hash().c_str());
    return recorder.steps() == 100 ? 0 : 1;
}
