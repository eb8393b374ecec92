// SPDX-License-Identifier: Apache-2.0
#include "clash/parts.h"

#include "executor/executor.h"
#include "mesh/components.h"
#include "mesh/measure.h"
#include "mesh/split.h"
#include "printable.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace raycontact {

namespace {

/// What a file has. Files are loaded side by side; the first in their order that cannot be loaded is the one named.
struct Loaded {
    std::vector<AssemblyPart> parts;
    std::vector<std::string> left_out;
    std::exception_ptr fault;
};

/// Names that several files have get the file before them.
void put_files_before(std::vector<AssemblyPart>& parts) {
    std::map<std::string, std::set<std::string>> files;
    for (const AssemblyPart& part : parts) files[part.name].insert(part.file);
    for (AssemblyPart& part : parts)
        if (files[part.name].size() > 1)
            part.name = part.name == std::filesystem::path(part.file).filename().string() ? part.file
                                                                                          : part.file + ":" + part.name;
}

/// Names that several parts have get a number.
void tell_apart(std::vector<AssemblyPart>& parts) {
    std::map<std::string, std::size_t> count;
    for (const AssemblyPart& part : parts) ++count[part.name];
    std::set<std::string> taken;
    for (const auto& [name, times] : count) taken.insert(name);
    std::map<std::string, std::size_t> given;
    for (AssemblyPart& part : parts) {
        if (count[part.name] < 2) continue;
        std::string numbered;
        do numbered = part.name + " #" + std::to_string(++given[part.name]);
        while (!taken.insert(numbered).second);
        part.name = numbered;
    }
}

} // namespace

std::vector<AssemblyPart> load_parts(const std::vector<std::filesystem::path>& files,
                                     std::vector<std::string>* left_out) {
    std::vector<Loaded> loaded(files.size());
    Executor executor(files.size() < 2 ? 1 : 0);
    executor.each(files.size(), 1, [&](std::uint32_t i) {
        try {
            loaded[i].parts = load_assembly(files[i], &loaded[i].left_out);
        } catch (...) {
            loaded[i].fault = std::current_exception();
        }
    });
    std::vector<AssemblyPart> parts;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (loaded[i].fault) std::rethrow_exception(loaded[i].fault);
        const std::size_t first = parts.size();
        for (AssemblyPart& part : loaded[i].parts) {
            if (part.parent != AssemblyPart::no_part) part.parent += first;
            if (files.size() > 1 && part.name != files[i].filename().string())
                part.under.insert(part.under.begin(), part.file);
            parts.push_back(std::move(part));
        }
        if (left_out != nullptr)
            for (const std::string& words : loaded[i].left_out)
                left_out->push_back(printable(files[i].string()) + ": " + words);
    }
    put_files_before(parts);
    tell_apart(parts);
    return parts;
}

std::vector<AssemblyPart> split_components(const std::vector<AssemblyPart>& parts, std::vector<std::string>* left_out) {
    struct Split {
        std::vector<std::shared_ptr<const Mesh>> meshes; ///< none: the part stays as it is
        bool is_tangled = false;
    };
    std::map<const Mesh*, Split> splits;
    std::vector<std::size_t> firsts; // parts, of each mesh one
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].mesh) throw InputError("split_components: " + parts[i].name + " has no mesh");
        if (splits.try_emplace(parts[i].mesh.get()).second) firsts.push_back(i);
    }
    const std::vector<clash::Part> near = clash::parts_of(parts); // prepare_mesh() refuses what is far
    Executor executor(0);
    const std::uint32_t of_one = executor.threads_of_each(firsts.size());
    executor.each(firsts.size(), 1, [&](std::uint32_t i) {
        const Mesh& whole = *parts[firsts[i]].mesh;
        Split& split = splits.at(&whole);
        try {
            const auto components = find_components(*near[firsts[i]].mesh, of_one);
            split.is_tangled = !components;
            if (!components || components->count < 2) return;
            for (Mesh& mesh : split_mesh(whole, components->of, components->count)) {
                mesh.name = whole.name;
                split.meshes.push_back(std::make_shared<const Mesh>(std::move(mesh)));
            }
        } catch (const InputError&) { // find_clashes() tells why, if it needs the part
        }
    });
    std::vector<AssemblyPart> all;
    std::vector<std::size_t> place(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        place[i] = all.size();
        const Split& split = splits.at(parts[i].mesh.get());
        if (split.meshes.empty()) all.push_back(parts[i]);
        for (const auto& mesh : split.meshes) all.emplace_back(parts[i]).mesh = mesh;
        if (split.is_tangled && left_out != nullptr)
            left_out->push_back(parts[i].name + ": not split: too many of its components lie in each other");
    }
    for (AssemblyPart& part : all)
        if (part.parent < place.size()) part.parent = place[part.parent];
    tell_apart(all);
    return all;
}

namespace clash {

namespace {

/// The mesh's name before a message; it may be another part's, too.
std::string without_name(const std::string& message, const std::string& name) {
    std::string text = message;
    for (const std::string& prefix : {name + ": ", "mesh '" + name + "': "})
        if (text.starts_with(prefix)) text.erase(0, prefix.size());
    return text;
}

} // namespace

// Shapes round vertices to a ten-millionth of their size.
Box box_of(const Part& part) {
    std::vector<Vec3> placed;
    placed.reserve(part.mesh->vertices.size());
    for (const Vec3& v : part.mesh->vertices) placed.push_back(transform_point(part.pose, v));
    const Box box = raycontact::box_of(placed);
    return world_box(box, {}, 1e-6 * length(box.high - box.low));
}

void check_assembly(std::span<const AssemblyPart> parts, const ClashOptions& options) {
    const auto check_length = [](double length, const std::string& what) {
        if (!(length >= 0 && std::isfinite(length)))
            throw InputError("clash: the " + what + " is no length; give a finite number of at least 0");
    };
    check_length(options.clearance, "clearance");
    check_length(options.tolerance, "tolerance");
    for (const ClearanceOf& some : options.clearances)
        check_length(some.clearance, "clearance of " + some.parts[0] + " and " + some.parts[1]);
    if (parts.size() < 2) throw InputError("clash: " + std::to_string(parts.size()) + " part given; give several");
    for (const AssemblyPart& part : parts) {
        if (!part.mesh) throw InputError("clash: " + part.name + " has no mesh");
        check_pose(part.pose, part.name.c_str());
    }
}

double smaller_size(const Part& a, const Part& b) {
    const auto size = [](const Shape& shape) { return length(shape.box_max() - shape.box_min()); };
    return std::min(size(*a.shape), size(*b.shape));
}

std::vector<Part> parts_of(std::span<const AssemblyPart> given) {
    // A multiple of this is taken off without rounding, as coordinates that far have no finer digits to lose.
    constexpr double grid = 1024, far = 1e6;
    std::map<const Mesh*, std::pair<std::shared_ptr<const Mesh>, Vec3>> near;
    std::vector<Part> parts;
    for (const AssemblyPart& part : given) {
        auto [at, is_new] = near.try_emplace(part.mesh.get(), part.mesh, Vec3{});
        auto& [mesh, origin] = at->second;
        if (is_new && !mesh->vertices.empty()) {
            const Box box = raycontact::box_of(mesh->vertices);
            const auto coarse = [](double x) { return std::fabs(x) > far ? grid * std::round(x / grid) : 0; };
            const Vec3 middle = box.middle();
            origin = {coarse(middle.x), coarse(middle.y), coarse(middle.z)};
            if (is_finite(origin) && origin != Vec3{}) {
                auto moved = std::make_shared<Mesh>(*mesh);
                for (Vec3& v : moved->vertices) v = v - origin;
                mesh = std::move(moved);
            } else {
                origin = {};
            }
        }
        parts.push_back({mesh, {part.pose.rotation, transform_point(part.pose, origin)}, nullptr, {}});
    }
    return parts;
}

double gap_between(const Box& a, const Box& b) {
    return length(most(most(a.low - b.high, b.low - a.high), Vec3{}));
}

std::vector<PartPair> near_boxes(const std::vector<Part>& parts, double reach) {
    std::vector<Box> boxes(parts.size());
    Executor executor(0);
    executor.each(parts.size(), 1, [&](std::uint32_t i) { boxes[i] = box_of(parts[i]); });
    std::vector<Box> grown = boxes;
    const Vec3 half{0.5 * reach, 0.5 * reach, 0.5 * reach};
    for (Box& box : grown) {
        box.low = box.low - half;
        box.high = box.high + half;
    }
    BoxTree tree;
    tree.build(executor, grown);
    BroadPhase broad_phase;
    const std::span<const SlotPair> found = broad_phase.find(executor, tree, {grown, {}});
    std::vector<PartPair> pairs;
    pairs.reserve(found.size());
    for (const auto& [a, b] : found)
        if (const double gap = gap_between(boxes[a], boxes[b]); gap <= reach) pairs.push_back({a, b, gap});
    return pairs;
}

void make_shapes(std::vector<Part>& parts, const std::vector<PartPair>& pairs, const ClashOptions& options,
                 const std::function<void(std::size_t, std::size_t)>& progress) {
    std::map<const Mesh*, std::vector<std::size_t>> users;
    std::vector<const Mesh*> wanted; // in the parts' order
    std::vector<char> seen(parts.size(), 0);
    for (const PartPair& pair : pairs)
        for (const std::size_t i : {pair.a, pair.b}) {
            if (std::exchange(seen[i], 1) != 0) continue;
            std::vector<std::size_t>& of_mesh = users[parts[i].mesh.get()];
            if (of_mesh.empty()) wanted.push_back(parts[i].mesh.get());
            of_mesh.push_back(i);
        }
    std::mutex mutex;
    std::size_t done = 0;
    Executor executor(options.threads);
    const std::uint32_t of_one = executor.threads_of_each(wanted.size());
    executor.run(static_cast<std::uint32_t>(wanted.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end && !options.stop(); ++i) {
            std::shared_ptr<const Shape> shape;
            std::string fault;
            try {
                shape = Shape::make(prepare_mesh(*wanted[i], {.check = Check::topology, .threads = of_one}), of_one);
            } catch (const InputError& error) {
                fault = without_name(error.what(), wanted[i]->name);
            }
            const std::lock_guard lock(mutex);
            for (const std::size_t part : users.at(wanted[i])) {
                parts[part].shape = shape;
                parts[part].fault = fault;
            }
            progress(++done, wanted.size());
        }
    });
}

} // namespace clash

} // namespace raycontact
