// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "shape/shape_data.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace raycontact {

namespace {

// Kernels count in 32 bits.
kernels::uint first_index(std::size_t size, std::size_t more) {
    if (size + more >= std::numeric_limits<kernels::uint>::max() / VERTEX_LANES)
        throw std::length_error("the shapes of this scene hold more than 2^28 vertices or triangles");
    return static_cast<kernels::uint>(size);
}

} // namespace

void ShapeStore::add(const std::shared_ptr<const Shape>& shape) {
    if (const auto found = entries_.find(shape.get()); found != entries_.end()) {
        ++found->second.users;
        return;
    }
    // Entered last: a shape that the device has no memory for leaves nothing behind.
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
    if (2 * bytes_dropped_ <= bytes_used_) return false;
    ++packed_;
    arrays_ = {};
    headers_.clear();
    bytes_used_ = bytes_dropped_ = 0;
    for (const Shape* shape : order_) upload(entries_.at(shape));
    return true;
}

void ShapeStore::upload(Entry& entry) {
    const ShapeData& data = entry.shape->data();
    kernels::ShapeHeader header = data.header;
    header.node_first = first_index(arrays_.nodes.size(), data.nodes.size());
    header.triangle_block_first = first_index(arrays_.triangle_blocks.size(), data.triangle_blocks.size());
    header.vertex_block_first = first_index(arrays_.vertex_blocks.size(), data.vertex_blocks.size());
    header.normal_first = first_index(arrays_.face_normals.size(), data.face_normals.size());
    header.face_first = first_index(arrays_.faces.size(), data.faces.size());
    header.clearance_first = first_index(arrays_.clearances.size(), data.clearances.size());
    header.grid_first = first_index(arrays_.outside_cells.size(), data.outside_cells.size());
    for (kernels::uint& first : header.cluster_first)
        first += first_index(arrays_.clusters.size(), data.clusters.size());
    entry.index = static_cast<kernels::uint>(arrays_.headers.size());
    headers_.reserve(entry.index + std::size_t{1});
    arrays_.headers.append(device_, std::span(&header, 1));
    arrays_.triangle_blocks.append(device_, std::span(data.triangle_blocks));
    arrays_.nodes.append(device_, std::span(data.nodes));
    arrays_.faces.append(device_, std::span(data.faces));
    arrays_.vertex_blocks.append(device_, std::span(data.vertex_blocks));
    arrays_.clusters.append(device_, std::span(data.clusters));
    arrays_.face_normals.append(device_, std::span(data.face_normals));
    arrays_.outside_cells.append(device_, std::span(data.outside_cells));
    arrays_.clearances.append(device_, std::span(data.clearances));
    headers_.resize(entry.index);
    headers_.push_back(header);
    bytes_used_ += entry.shape->memory_bytes();
}

} // namespace raycontact
