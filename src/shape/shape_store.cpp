// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "shape/accelerators.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace raycontact {

namespace {

std::vector<kernels::TriangleBlock> with_caps(std::vector<kernels::TriangleBlock> blocks,
                                              std::span<const kernels::uint> caps) {
    for (std::size_t i = 0; i < caps.size(); ++i) blocks[i / TRIANGLE_LANES].cap[i % TRIANGLE_LANES] = caps[i];
    return blocks;
}

// Appends to an array and returns the place; kernels count in 32 bits.
template <class T>
bool has_room(const Array<T>& array, const std::vector<T>& more) {
    return array.size() + more.size() < std::numeric_limits<kernels::uint>::max() / VERTEX_LANES;
}
template <class T>
kernels::uint append(Device& device, Array<T>& array, const std::vector<T>& more) {
    const std::size_t first = array.size();
    if (!has_room(array, more))
        throw std::length_error("the shapes of this scene hold more than 2^28 vertices or triangles");
    array.append(device, std::span(more));
    return static_cast<kernels::uint>(first);
}

} // namespace

void ShapeStore::add(const std::shared_ptr<const Shape>& shape) {
    if (const auto found = entries_.find(shape.get()); found != entries_.end()) {
        ++found->second.users;
        return;
    }
    // Entered last: a shape too large for the device has no entry, and leaves at most unused elements in the arrays.
    Entry entry{shape, 0, 1, 0};
    const bool accelerated = upload(entry);
    order_.reserve(order_.size() + 1);
    const Entry& entered = entries_.emplace(shape.get(), std::move(entry)).first->second;
    if (!accelerated) note_plain(entered);
    order_.push_back(shape.get());
}

void ShapeStore::remove(const Shape* shape) {
    const auto found = entries_.find(shape);
    if (--found->second.users > 0) return;
    bytes_dropped_ += found->second.bytes;
    no_longer_plain(found->second.index, shape);
    order_.erase(std::find(order_.begin(), order_.end(), shape));
    entries_.erase(found);
}

bool ShapeStore::pack() {
    if (whole_ && 2 * bytes_dropped_ <= bytes_used_) return false;
    ++packed_;
    arrays_ = {};
    headers_.clear();
    plain_shapes_.clear();
    bytes_used_ = bytes_dropped_ = 0;
    plain_ = 0;
    whole_ = false; // if an upload throws, the next call begins anew
    for (const Shape* shape : order_) {
        Entry& entry = entries_.at(shape);
        if (!upload(entry)) note_plain(entry);
    }
    whole_ = true;
    return true;
}

bool ShapeStore::upload(Entry& entry) {
    const ShapeData& data = entry.shape->data();
    const Accelerators* more = entry.shape->accelerators();
    kernels::ShapeHeader header = more != nullptr ? more->header : data.header;
    header.node_first = append(device_, arrays_.nodes, data.nodes);
    header.triangle_block_first = append(
        device_, arrays_.triangle_blocks,
        more != nullptr && !more->caps.empty() ? with_caps(data.triangle_blocks, more->caps) : data.triangle_blocks);
    const kernels::uint block_first = append(device_, arrays_.vertex_blocks, data.vertex_blocks);
    header.normal_first = append(device_, arrays_.face_normals, data.face_normals);
    header.face_first = append(device_, arrays_.faces, data.faces);
    header.clearance_first = append(device_, arrays_.clearances, more != nullptr ? more->clearances : data.clearances);
    if (more != nullptr) header.grid_first = append(device_, arrays_.outside_cells, more->outside_cells);
    const kernels::uint cluster_first = append(device_, arrays_.clusters, data.clusters);
    for (kernels::SourceTree* tree : {&header.vertices, &header.edges}) {
        tree->block_first += block_first;
        for (kernels::uint& first : tree->cluster_first) first += cluster_first;
    }
    headers_.reserve(headers_.size() + 1);
    plain_shapes_.resize(headers_.size() + 1, nullptr);
    arrays_.headers.append(device_, std::span(&header, 1));
    entry.index = static_cast<kernels::uint>(headers_.size());
    headers_.push_back(header);
    entry.bytes = entry.shape->memory_bytes();
    bytes_used_ += entry.bytes;
    return more != nullptr;
}

void ShapeStore::accelerate() {
    if (plain_ == 0) return;
    for (kernels::uint i = 0; i < plain_shapes_.size(); ++i) {
        const Shape* shape = plain_shapes_[i];
        if (shape == nullptr || shape->accelerators() == nullptr) continue;
        upload_accelerators(entries_.at(shape), *shape->accelerators());
        no_longer_plain(i, shape);
    }
}

void ShapeStore::note_plain(const Entry& entry) {
    plain_shapes_[entry.index] = entry.shape.get();
    ++plain_;
}

// A pack that failed may have left another index.
void ShapeStore::no_longer_plain(kernels::uint index, const Shape* shape) {
    if (index >= plain_shapes_.size() || plain_shapes_[index] != shape) return;
    plain_shapes_[index] = nullptr;
    --plain_;
}

// The grids go to the ends of their arrays; the word of the grid of one cell stays, unused.
void ShapeStore::upload_accelerators(Entry& entry, const Accelerators& more) {
    if (!has_room(arrays_.clearances, more.clearances) || !has_room(arrays_.outside_cells, more.outside_cells)) return;
    const kernels::ShapeHeader before = headers_[entry.index];
    kernels::ShapeHeader header = more.header;
    header.node_first = before.node_first;
    header.triangle_block_first = before.triangle_block_first;
    header.vertices = before.vertices;
    header.edges = before.edges;
    header.normal_first = before.normal_first;
    header.face_first = before.face_first;
    header.clearance_first = append(device_, arrays_.clearances, more.clearances);
    header.grid_first = append(device_, arrays_.outside_cells, more.outside_cells);
    const auto write = [&](auto& array, std::size_t first, const auto* values, std::size_t count) {
        device_.queue().write(*array.buffer(), first * sizeof *values, values, count * sizeof *values);
    };
    if (!more.caps.empty()) {
        const auto blocks = with_caps(entry.shape->data().triangle_blocks, more.caps);
        write(arrays_.triangle_blocks, header.triangle_block_first, blocks.data(), blocks.size());
    }
    write(arrays_.headers, entry.index, &header, 1);
    headers_[entry.index] = header;
    bytes_used_ += more.bytes();
    entry.bytes += more.bytes();
}

} // namespace raycontact
