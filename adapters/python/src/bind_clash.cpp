// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "bind.h"
#include "without_gil.h"

#include <clash/parts.h>
#include <clash/search.h>

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

using clash::Clash;
using clash::Part;

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

nb::list tuples_of(const std::vector<Part>& parts) {
    nb::list list;
    for (const Part& part : parts)
        list.append(nb::make_tuple(part.name, std::const_pointer_cast<Mesh>(part.mesh), matrices_of({&part.pose, 1})));
    return list;
}

nb::tuple tuple_of(const Clash& found) {
    const auto three = [](const Vec3& v) { return array_of(std::vector<double>{v.x, v.y, v.z}, {3}); };
    return nb::make_tuple(found.a, found.b, found.depth, three(found.point),
                          found.contacts > 0 ? nb::cast(three(found.normal)) : nb::none(), found.contacts,
                          found.duplicate);
}

/// progress: None, or a function of what is done, from 0 to 1.
nb::tuple find_clashes(const std::vector<std::string>& names, const std::vector<std::shared_ptr<Mesh>>& meshes,
                       const Matrices& matrices, std::uint32_t threads, const nb::object& progress) {
    if (names.size() != meshes.size() || names.size() != matrices.shape(0))
        throw nb::value_error("clash: as many names, meshes and poses are needed");
    std::vector<Part> parts;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!meshes[i]) throw nb::value_error("clash: a mesh is None");
        Part part;
        part.name = names[i];
        part.mesh = meshes[i];
        part.pose = pose_at(matrices, i);
        check_pose(part.pose, part.name.c_str());
        parts.push_back(std::move(part));
    }
    std::vector<clash::PartPair> pairs;
    std::vector<Clash> clashes;
    {
        WithoutGil without_gil;
        Interruption interruption(without_gil);
        const auto stop = [&] { return interruption.stop(); };
        const auto tell = [&](double from, double to) {
            return [&, from, to](std::size_t done, std::size_t total) {
                if (progress.is_none()) return;
                interruption.run([&] {
                    const nb::gil_scoped_acquire gil;
                    progress(from + (to - from) * double(done) / double(total));
                });
            };
        };
        pairs = clash::touching_boxes(parts);
        clash::make_shapes(parts, pairs, threads, tell(0, 0.7), stop); // most of the time
        if (!interruption.stop()) clashes = clash::find_clashes(parts, pairs, {threads, tell(0.7, 1), stop});
        interruption.rethrow();
    }
    nb::list found, faults, open;
    for (const Clash& one : clashes) found.append(tuple_of(one));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].fault.empty()) faults.append(nb::make_tuple(i, parts[i].fault));
        if (parts[i].shape && !parts[i].shape->report().closed) open.append(i);
    }
    return nb::make_tuple(found, pairs.size(), faults, open);
}

} // namespace

void bind_clash(nb::module_& m) {
    m.def(
        "load_parts",
        [](const std::vector<std::filesystem::path>& files) {
            std::vector<Part> parts;
            std::vector<std::string> left_out;
            {
                const WithoutGil without_gil;
                parts = clash::load_parts(files, left_out);
            }
            return nb::make_tuple(tuples_of(parts), left_out);
        },
        "files"_a);
    m.def("find_clashes", &find_clashes, "names"_a, "meshes"_a, "poses"_a, "threads"_a, "progress"_a.none());
}

} // namespace raycontact::python
