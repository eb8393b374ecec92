// SPDX-License-Identifier: Apache-2.0
#include "bind.h"
#include "guarded_scene.h"

#include <raycontact/recorder.h>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>

namespace nb = nanobind;
using namespace nanobind::literals;

namespace raycontact::python {

namespace {

/// A recorder, and the scene that must outlive it.
class SceneRecorder {
public:
    SceneRecorder(const std::filesystem::path& file, GuardedScene& scene, const RecorderOptions& options)
        : scene_(scene), recorder_(file, *scene.enter(), options) {}

    void record() {
        const auto in_use = scene_.enter();
        recorder_.record();
    }
    Recorder& recorder() { return recorder_; }

private:
    GuardedScene& scene_;
    Recorder recorder_;
};

} // namespace

void bind_recorder(nb::module_& m) {
    nb::class_<SceneRecorder>(m, "Recorder")
        .def(
            "__init__",
            [](SceneRecorder* self, const std::filesystem::path& file, GuardedScene& scene, const std::string& name,
               double dt, const std::string& mesh_source) {
                RecorderOptions options;
                options.scene = name;
                options.dt = dt;
                options.mesh_source = mesh_source;
                new (self) SceneRecorder(file, scene, options);
            },
            "file"_a, "scene"_a, "name"_a, "dt"_a, "mesh_source"_a, nb::keep_alive<1, 3>())
        .def("record", &SceneRecorder::record)
        .def("finish", [](SceneRecorder& self) { self.recorder().finish(); })
        .def_prop_ro("steps", [](SceneRecorder& self) { return self.recorder().steps(); })
        .def_prop_ro("bytes", [](SceneRecorder& self) { return self.recorder().bytes(); })
        .def_prop_ro("hash", [](SceneRecorder& self) { return self.recorder().hash(); });
}

} // namespace raycontact::python
