// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "shape/shape_data.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace raycontact {

namespace {

// Appends to an array and returns the place; kernels count in 32 bits.
template <class T>
kernels::uint append(Device& device, Array<T>& array, const std::vector<T>& more) {
    const std::size_t first = array.size();
    if (first + more.size() >= std::numeric_limits<kernels::uint>::max() / VERTEX_LANES)
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
    Entry entry{shape, 0, 1};
    upload(entry);
    order_.reserve(order_.size() + 1);
    entries_.emplace(shape.get(), std::move(entry));
    order_.push_back(shape.get());
}

void ShapeStore::remove(const Shape* shape) {
    const auto found = entries_.find(shape);
    if (--found->second.users > 0) return;
    bytes_dropped_ += shape->memory_bytes();
    order_.erase(std::find(order_.begin(), order_.end(), shape));
    entries_.erase(found);
}

bool ShapeStore::pack() {
    if (whole_ && 2 * bytes_dropped_ <= bytes_used_) return false;
    ++packed_;
    arrays_ = {};
    headers_.clear();
    bytes_used_ = bytes_dropped_ = 0;
    whole_ = false; // if an upload throws, the next call begins anew
    for (const Shape* shape : order_) upload(entries_.at(shape));
    whole_ = true;
    return true;
}

void ShapeStore::upload(Entry& entry) {
    const ShapeData& data = entry.shape->data();
    kernels::ShapeHeader header = data.header;
    header.node_first = append(device_, arrays_.nodes, data.nodes);
    header.triangle_block_first = append(device_, arrays_.triangle_blocks, data.triangle_blocks);
    header.vertex_block_first = append(device_, arrays_.vertex_blocks, data.vertex_blocks);
    header.normal_first = append(device_, arrays_.face_normals, data.face_normals);
    header.face_first = append(device_, arrays_.faces, data.faces);
    header.clearance_first = append(device_, arrays_.clearances, data.clearances);
    header.grid_first = append(device_, arrays_.outside_cells, data.outside_cells);
    const kernels::uint cluster_first = append(device_, arrays_.clusters, data.clusters);
    for (kernels::uint& first : header.cluster_first) first += cluster_first;
    headers_.reserve(headers_.size() + 1);
    arrays_.headers.append(device_, std::span(&header, 1));
    entry.index = static_cast<kernels::uint>(headers_.size());
    headers_.push_back(header);
    bytes_used_ += entry.shape->memory_bytes();
}

} // namespace raycontact
