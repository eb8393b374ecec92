// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "bind.h"
#include "columns.h"
#include "guarded_scene.h"
#include "settings_words.h"

#include <recording/reader.h>

#include <raycontact/error.h>
#include <raycontact/recorder.h>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <unordered_map>

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

/// A recording whose bodies are known by their numbers.
class NumberedReader {
public:
    explicit NumberedReader(const std::filesystem::path& file) : reader_(file) {
        for (const recording::Body& body : reader_.bodies()) numbers_.emplace(body.id, std::int64_t(numbers_.size()));
    }

    const recording::Reader& reader() const { return reader_; }

    /// Poses (n, 4, 4), the identity for bodies that are not there; whether they are, (n,); pairs of numbers (m, 2).
    nb::tuple step(std::uint32_t i) {
        if (i >= reader_.steps())
            throw InputError("recording: there is no step " + std::to_string(i) + "; it has "
                             + std::to_string(reader_.steps()));
        std::vector<Pose> by_slot;
        std::vector<Pair> pairs;
        reader_.read_step(i, by_slot, pairs);
        const std::size_t n = reader_.bodies().size();
        std::vector<Pose> poses(n);
        AnswerColumn present(n);
        for (std::size_t k = 0; k < n; ++k) {
            const recording::Body& body = reader_.bodies()[k];
            if (!body.alive(i)) continue;
            present.set(k, true);
            poses[k] = by_slot[body.id.slot];
        }
        std::vector<std::int64_t> met;
        for (const auto& [a, b] : pairs) met.insert(met.end(), {numbers_.at(a), numbers_.at(b)});
        return nb::make_tuple(matrices_of(poses), present.take(), array_of(std::move(met), {pairs.size(), 2}));
    }

private:
    recording::Reader reader_;
    std::unordered_map<BodyId, std::int64_t> numbers_;
};

nb::list shapes_of(const NumberedReader& recording) {
    nb::list list;
    for (const auto& shape : recording.reader().shapes()) list.append(std::const_pointer_cast<Shape>(shape));
    return list;
}

/// A number of each body.
template <typename Get>
Array of_bodies(const NumberedReader& recording, Get&& get) {
    const auto& bodies = recording.reader().bodies();
    IndexColumn column(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) column.set(i, get(bodies[i]));
    return column.take();
}

} // namespace

void bind_recordings(nb::module_& m) {
    nb::class_<NumberedReader>(m, "Recording")
        .def(nb::init<const std::filesystem::path&>(), "file"_a)
        .def("shapes", &shapes_of)
        .def("shape_of",
             [](const NumberedReader& self) {
                 return of_bodies(self, [](const recording::Body& body) { return std::int64_t(body.shape); });
             })
        .def("ids",
             [](const NumberedReader& self) {
                 return of_bodies(self, [](const recording::Body& body) { return number_of(body.id); });
             })
        .def_prop_ro("settings", [](const NumberedReader& self) { return words_of(self.reader().info().settings); })
        .def_prop_ro("name", [](const NumberedReader& self) { return self.reader().info().scene; })
        .def_prop_ro("dt", [](const NumberedReader& self) { return self.reader().info().dt; })
        .def_prop_ro("hash", [](const NumberedReader& self) { return self.reader().hash(); })
        .def_prop_ro("steps", [](const NumberedReader& self) { return self.reader().steps(); })
        .def("step", &NumberedReader::step, "i"_a);
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
