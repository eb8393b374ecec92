// SPDX-License-Identifier: Apache-2.0
#include <clash/parts.h>

#include "broadphase/broad_phase.h"
#include "executor/executor.h"
#include "mesh/measure.h"
#include "printable.h"

#include <raycontact/error.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace raycontact::clash {

namespace {

/// Shapes round vertices to a ten-millionth of their size.
WorldBox box_of(const AssemblyPart& part, BodySlot number) {
    std::vector<Vec3> placed;
    placed.reserve(part.mesh->vertices.size());
    for (const Vec3& v : part.mesh->vertices) placed.push_back(transform_point(part.pose, v));
    const Box box = raycontact::box_of(placed);
    return {world_box(box, {}, 1e-6 * length(box.high - box.low)), number};
}

/// Names that several files have get the file before them, then names that several parts have a number.
void tell_apart(std::vector<Part>& parts, const std::vector<std::filesystem::path>& file_of) {
    std::map<std::string, std::set<std::filesystem::path>> files;
    for (std::size_t i = 0; i < parts.size(); ++i) files[parts[i].name].insert(file_of[i]);
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (files[parts[i].name].size() > 1)
            parts[i].name = parts[i].name == file_of[i].filename().string() ? file_of[i].string()
                                                                            : file_of[i].string() + ":" + parts[i].name;
    std::map<std::string, std::size_t> count;
    for (const Part& part : parts) ++count[part.name];
    std::set<std::string> taken;
    for (const auto& [name, times] : count) taken.insert(name);
    std::map<std::string, std::size_t> given;
    for (Part& part : parts) {
        if (count[part.name] < 2) continue;
        std::string numbered;
        do numbered = part.name + " #" + std::to_string(++given[part.name]);
        while (!taken.insert(numbered).second);
        part.name = numbered;
    }
}

/// The mesh's name before a message; it may be another part's, too.
std::string without_name(const std::string& message, const std::string& name) {
    std::string text = message;
    for (const std::string& prefix : {name + ": ", "mesh '" + name + "': "})
        if (text.starts_with(prefix)) text.erase(0, prefix.size());
    return text;
}

} // namespace

double smaller_size(const Part& a, const Part& b) {
    const auto size = [](const Shape& shape) { return length(shape.box_max() - shape.box_min()); };
    return std::min(size(*a.shape), size(*b.shape));
}

std::vector<Part> load_parts(const std::vector<std::filesystem::path>& files, std::vector<std::string>& left_out) {
    std::vector<Part> parts;
    std::vector<std::filesystem::path> file_of;
    for (const std::filesystem::path& file : files) {
        std::vector<std::string> of_file;
        for (AssemblyPart& part : load_assembly(file, &of_file)) {
            parts.push_back({std::move(part), nullptr, {}});
            file_of.push_back(file);
        }
        for (const std::string& words : of_file) left_out.push_back(printable(file.string()) + ": " + words);
    }
    tell_apart(parts, file_of);
    return parts;
}

std::vector<PartPair> touching_boxes(const std::vector<Part>& parts) {
    std::vector<WorldBox> boxes;
    for (std::size_t i = 0; i < parts.size(); ++i) boxes.push_back(box_of(parts[i], static_cast<BodySlot>(i)));
    std::vector<SlotPair> found;
    Executor executor(boxes.size() < 1000 ? 1 : 0);
    BroadPhase().find(executor, boxes, found);
    std::vector<PartPair> pairs;
    pairs.reserve(found.size());
    for (const auto& [a, b] : found) pairs.push_back({a, b});
    return pairs;
}

void make_shapes(std::vector<Part>& parts, const std::vector<PartPair>& pairs, std::uint32_t threads,
                 const std::function<void(std::size_t, std::size_t)>& progress, const std::function<bool()>& stop) {
    std::map<const Mesh*, std::vector<std::size_t>> users;
    std::vector<const Mesh*> wanted; // in the parts' order
    std::vector<char> seen(parts.size(), 0);
    for (const auto& [a, b] : pairs)
        for (const std::size_t i : {a, b}) {
            if (std::exchange(seen[i], 1) != 0) continue;
            std::vector<std::size_t>& of_mesh = users[parts[i].mesh.get()];
            if (of_mesh.empty()) wanted.push_back(parts[i].mesh.get());
            of_mesh.push_back(i);
        }
    std::mutex mutex;
    std::size_t done = 0;
    Executor executor(threads);
    const std::uint32_t of_one = executor.threads_of_each(wanted.size());
    executor.run(static_cast<std::uint32_t>(wanted.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end && !stop(); ++i) {
            std::shared_ptr<const Shape> shape;
            std::string fault;
            try {
                shape = Shape::make(
                    prepare_mesh(*wanted[i], Repair::allowed, Nesting::as_wound, Check::topology, of_one), of_one);
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

} // namespace raycontact::clash
