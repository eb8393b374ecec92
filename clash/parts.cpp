// SPDX-License-Identifier: Apache-2.0
#include <clash/parts.h>

#include <clash/side_by_side.h>

#include <raycontact/error.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

namespace raycontact::clash {

namespace {

struct Box {
    Vec3 low, high;
    std::size_t part;
};

Box box_of(const AssemblyPart& placed, std::size_t part) {
    const Vec3 first = transform_point(placed.pose, placed.mesh->vertices.front());
    Box box{first, first, part};
    for (const Vec3& vertex : placed.mesh->vertices) {
        const Vec3 v = transform_point(placed.pose, vertex);
        box.low = {std::min(box.low.x, v.x), std::min(box.low.y, v.y), std::min(box.low.z, v.z)};
        box.high = {std::max(box.high.x, v.x), std::max(box.high.y, v.y), std::max(box.high.z, v.z)};
    }
    // Shapes round vertices to a ten-millionth of their size.
    const double grow = 1e-6 * std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z});
    box.low = {box.low.x - grow, box.low.y - grow, box.low.z - grow};
    box.high = {box.high.x + grow, box.high.y + grow, box.high.z + grow};
    return box;
}

void tell_apart(std::vector<Part>& parts) {
    std::map<std::string, std::size_t> count;
    for (const Part& part : parts) ++count[part.name];
    std::map<std::string, std::size_t> given;
    for (Part& part : parts)
        if (count[part.name] > 1) part.name += " #" + std::to_string(++given[part.name]);
}

} // namespace

std::vector<Part> load_parts(const std::vector<std::filesystem::path>& files) {
    std::vector<Part> parts;
    for (const std::filesystem::path& file : files)
        for (AssemblyPart& part : load_assembly(file)) parts.push_back({std::move(part), nullptr, {}});
    tell_apart(parts);
    return parts;
}

// Sorted by their lower x, so a box meets only those that begin before it ends.
std::vector<PartPair> touching_boxes(const std::vector<Part>& parts) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < parts.size(); ++i) boxes.push_back(box_of(parts[i], i));
    std::sort(boxes.begin(), boxes.end(), [](const Box& p, const Box& q) { return p.low.x < q.low.x; });
    std::vector<PartPair> pairs;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        for (std::size_t k = i + 1; k < boxes.size() && boxes[k].low.x <= boxes[i].high.x; ++k) {
            const Box &p = boxes[i], &q = boxes[k];
            if (p.low.y <= q.high.y && q.low.y <= p.high.y && p.low.z <= q.high.z && q.low.z <= p.high.z)
                pairs.push_back({std::min(p.part, q.part), std::max(p.part, q.part)});
        }
    std::sort(pairs.begin(), pairs.end(),
              [](const PartPair& p, const PartPair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
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
    for_each_beside(
        wanted.size(), threads,
        [&](std::size_t i) {
            std::shared_ptr<const Shape> shape;
            std::string fault;
            try {
                shape = Shape::make(prepare_mesh(*wanted[i], Repair::allowed, Nesting::as_wound, Check::topology));
            } catch (const InputError& error) {
                fault = error.what();
            }
            const std::lock_guard lock(mutex);
            for (const std::size_t part : users.at(wanted[i])) {
                parts[part].shape = shape;
                parts[part].fault = fault;
            }
            progress(++done, wanted.size());
        },
        stop);
}

} // namespace raycontact::clash
