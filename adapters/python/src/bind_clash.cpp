// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "bind.h"
#include "without_gil.h"

#include <raycontact/clash.h>

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <thread>

namespace raycontact::python {

namespace {

/// Ends a search when Ctrl-C is pressed or the user's function throws.
class Interruption {
public:
    explicit Interruption(WithoutGil& without_gil) : without_gil_(without_gil) {}

    /// From any thread; looks for Ctrl-C in the one that this was made in, now and then.
    bool stop() {
        using Clock = std::chrono::steady_clock;
        if (std::this_thread::get_id() == caller_ && Clock::now() - looked_ > std::chrono::milliseconds(50)) {
            run([&] { without_gil_.check_signals(); });
            looked_ = Clock::now();
        }
        return stopped_ || is_ending();
    }
    /// From one thread at a time.
    template <typename Work>
    void run(Work&& work) {
        if (stopped_) return;
        try {
            work();
        } catch (...) {
            if (stopped_.exchange(true)) return;
            failure_ = std::current_exception();
        }
    }
    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    WithoutGil& without_gil_;
    std::thread::id caller_ = std::this_thread::get_id();
    std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
    std::atomic<bool> stopped_ = false;
    std::exception_ptr failure_;
};

/// Names, meshes and poses, then files, parents, -1 for none, and what they are under.
nb::tuple tuples_of(const std::vector<AssemblyPart>& parts) {
    nb::list list, files, parents, unders;
    for (const AssemblyPart& part : parts) {
        list.append(nb::make_tuple(part.name, std::const_pointer_cast<Mesh>(part.mesh), matrices_of({&part.pose, 1})));
        files.append(part.file);
        unders.append(part.under);
        parents.append(part.parent == AssemblyPart::no_part ? std::ptrdiff_t{-1} : std::ptrdiff_t(part.parent));
    }
    return nb::make_tuple(list, files, parents, unders);
}

Array three(const Vec3& v) {
    return array_of(std::vector<double>{v.x, v.y, v.z}, {3});
}

Array corners_of(const AxisBox& b) {
    return array_of(std::vector<double>{b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z}, {2, 3});
}

/// In the order of the fields of Python's Clash, without the names.
nb::tuple tuple_of(const Clash& found) {
    const auto parted = [](const Separation& s) {
        return nb::make_tuple(s.distance, three(s.normal), three(s.point_a), three(s.point_b));
    };
    return nb::make_tuple(found.depth, three(found.point),
                          found.normal != Vec3{} ? nb::cast(three(found.normal)) : nb::none(), found.contacts,
                          found.kind == ClashKind::duplicate, found.a, found.b, to_string(found.kind), found.distance,
                          three(found.point_a), three(found.point_b), nb::make_tuple(found.open_a, found.open_b),
                          found.box ? nb::cast(corners_of(*found.box)) : nb::none(), found.volume,
                          found.separation ? nb::object(parted(*found.separation)) : nb::none());
}

using Unders = std::vector<std::vector<std::string>>; ///< AssemblyPart::under

/// files, parents and unders: of none, or as many as names.
std::vector<AssemblyPart> parts_from(const std::vector<std::string>& names,
                                     const std::vector<std::shared_ptr<Mesh>>& meshes, const Matrices& matrices,
                                     const std::vector<std::string>& files, const std::vector<std::ptrdiff_t>& parents,
                                     const Unders& unders) {
    const auto fits = [&](std::size_t size) { return size == names.size(); };
    if (!fits(meshes.size()) || !fits(matrices.shape(0)) || (!files.empty() && !fits(files.size()))
        || (!parents.empty() && !fits(parents.size())) || (!unders.empty() && !fits(unders.size())))
        throw nb::value_error("clash: as many names, meshes and poses are needed");
    std::vector<AssemblyPart> parts;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!meshes[i]) throw nb::value_error("clash: a mesh is None");
        AssemblyPart part{names[i], meshes[i], pose_at(matrices, i)};
        if (!files.empty()) part.file = files[i];
        if (!unders.empty()) part.under = unders[i];
        if (!parents.empty() && parents[i] >= 0) part.parent = std::size_t(parents[i]);
        parts.push_back(std::move(part));
    }
    return parts;
}

/// A search that Ctrl-C ends, and a progress that throws. progress: None, or a function of what is done, from 0 to 1.
template <typename Find>
auto found_by(const Find& find, ClashOptions options, const nb::object& progress) {
    WithoutGil without_gil;
    Interruption interruption(without_gil);
    options.stop = [&] { return interruption.stop(); };
    if (!progress.is_none())
        options.progress = [&](double done) {
            interruption.run([&] {
                const nb::gil_scoped_acquire gil;
                progress(done);
            });
        };
    auto report = find(options);
    interruption.rethrow();
    return report;
}

nb::list faults_of(const auto& report) {
    nb::list faults;
    for (const auto& [part, why] : report.faults) faults.append(nb::make_tuple(part, why));
    return faults;
}

/// files, parents and unders: as parts_from() has them.
nb::tuple find_clashes_of(const std::vector<std::string>& names, const std::vector<std::shared_ptr<Mesh>>& meshes,
                          const Matrices& matrices, const std::vector<std::string>& files,
                          const std::vector<std::ptrdiff_t>& parents, const Unders& unders, const ClashOptions& options,
                          const nb::object& progress) {
    const std::vector<AssemblyPart> parts = parts_from(names, meshes, matrices, files, parents, unders);
    const ClashReport report =
        found_by([&](const ClashOptions& how) { return find_clashes(parts, how); }, options, progress);
    nb::list found;
    for (const Clash& one : report.clashes) found.append(tuple_of(one));
    nb::list paths;
    for (const AssemblyPart& part : parts) paths.append(path_of(part));
    return nb::make_tuple(found, report.pairs, faults_of(report), nb::cast(report.open), paths);
}

/// boxes: of each clash low and high, or its point twice. level: below 0: groups of parts.
nb::list groups_of(const std::vector<std::string>& names, const std::vector<std::string>& files, const Unders& unders,
                   const std::vector<std::array<std::size_t, 2>>& pairs,
                   const std::vector<std::array<double, 6>>& boxes, int level) {
    if (boxes.size() != pairs.size()) throw nb::value_error("clash: as many pairs and boxes are needed");
    std::vector<AssemblyPart> parts(names.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        parts[i].name = names[i];
        if (!files.empty()) parts[i].file = files.at(i);
        if (!unders.empty()) parts[i].under = unders.at(i);
    }
    std::vector<Clash> clashes(pairs.size());
    for (std::size_t i = 0; i < clashes.size(); ++i) {
        const auto& b = boxes[i];
        clashes[i].a = pairs[i][0];
        clashes[i].b = pairs[i][1];
        clashes[i].box = AxisBox{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    }
    nb::list found;
    for (const ClashGroup& group :
         level < 0 ? group_by_part(parts, clashes) : group_by_assembly(parts, clashes, std::size_t(level)))
        found.append(nb::make_tuple(group.a, group.b, group.clashes, corners_of(group.box)));
    return found;
}

/// In the order of the fields of Python's PathClash, without the names.
nb::tuple tuple_of(const PathClash& found) {
    return nb::make_tuple(found.meet, found.place.time, found.place.distance, three(found.place.point_a),
                          three(found.place.point_b), found.moving, found.other);
}

nb::tuple find_path_clashes_of(const std::vector<std::string>& names, const std::vector<std::shared_ptr<Mesh>>& meshes,
                               const Matrices& matrices, const std::vector<std::string>& files,
                               const std::vector<std::ptrdiff_t>& parents, const Unders& unders,
                               const std::vector<std::string>& moving, const Matrices& moves,
                               const ClashOptions& options, const nb::object& progress) {
    const std::vector<AssemblyPart> parts = parts_from(names, meshes, matrices, files, parents, unders);
    const std::vector<Pose> path = poses_of(moves);
    const PathClashReport report = found_by(
        [&](const ClashOptions& how) { return find_path_clashes(parts, moving, path, how); }, options, progress);
    nb::list found;
    for (const PathClash& one : report.clashes) found.append(tuple_of(one));
    return nb::make_tuple(found, report.nearest ? tuple_of(*report.nearest) : nb::object(nb::none()), report.pairs,
                          faults_of(report));
}

} // namespace

void bind_clash(nb::module_& m) {
    m.def(
        "load_parts",
        [](const std::vector<std::filesystem::path>& files) {
            std::vector<AssemblyPart> parts;
            std::vector<std::string> left_out;
            {
                const WithoutGil without_gil;
                parts = load_parts(files, &left_out);
            }
            return nb::make_tuple(tuples_of(parts), left_out);
        },
        "files"_a);
    m.def(
        "split_components",
        [](const std::vector<std::string>& names, const std::vector<std::shared_ptr<Mesh>>& meshes,
           const Matrices& matrices, const std::vector<std::string>& files, const std::vector<std::ptrdiff_t>& parents,
           const Unders& unders) {
            std::vector<AssemblyPart> parts = parts_from(names, meshes, matrices, files, parents, unders);
            std::vector<std::string> left_out;
            {
                const WithoutGil without_gil;
                parts = split_components(parts, &left_out);
            }
            return nb::make_tuple(tuples_of(parts), left_out);
        },
        "names"_a, "meshes"_a, "poses"_a, "files"_a, "parents"_a, "unders"_a);
    nb::class_<ClearanceOf>(m, "ClearanceOf")
        .def(
            "__init__",
            [](ClearanceOf* self, double clearance, const std::array<std::string, 2>& parts) {
                new (self) ClearanceOf{clearance, parts};
            },
            "clearance"_a, "parts"_a);
    nb::class_<ClashOptions>(m, "ClashOptions")
        .def(nb::init<>())
        .def_rw("against", &ClashOptions::against)
        .def_rw("exclude", &ClashOptions::exclude)
        .def_rw("exclude_parent_child", &ClashOptions::exclude_parent_child)
        .def_rw("clearance", &ClashOptions::clearance)
        .def_rw("clearances", &ClashOptions::clearances)
        .def_rw("tolerance", &ClashOptions::tolerance)
        .def_rw("volumes", &ClashOptions::volumes)
        .def_rw("separations", &ClashOptions::separations)
        .def_rw("threads", &ClashOptions::threads);
    m.def("find_clashes", &find_clashes_of, "names"_a, "meshes"_a, "poses"_a, "files"_a, "parents"_a, "unders"_a,
          "options"_a, "progress"_a.none());
    m.def("group_clashes", &groups_of, "names"_a, "files"_a, "unders"_a, "pairs"_a, "boxes"_a, "level"_a);
    m.def("find_path_clashes", &find_path_clashes_of, "names"_a, "meshes"_a, "poses"_a, "files"_a, "parents"_a,
          "unders"_a, "moving"_a, "moves"_a, "options"_a, "progress"_a.none());
}

} // namespace raycontact::python
