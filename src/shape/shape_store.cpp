// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "shape/accelerators.h"

#include <algorithm>

namespace raycontact {

namespace {

template <class T>
std::pair<const std::vector<T>&, kernels::ulong&> array(const std::vector<T>& values, kernels::ulong& place) {
    return {values, place};
}

} // namespace

// Arrays go to the end of the device's memory, each in lines of its own; their places are entered.
template <class... T>
void ShapeStore::copy(const std::pair<const std::vector<T>&, kernels::ulong&>&... arrays) {
    constexpr std::size_t line = 64, word = sizeof(kernels::ulong);
    std::size_t end = arrays_.memory.size();
    ((arrays.second = end, end += (arrays.first.size() * sizeof(T) + line - 1) / line * (line / word)), ...);
    arrays_.memory.extend(device_, end);
    const auto write = [&](kernels::ulong place, const void* values, std::size_t bytes) {
        if (bytes > 0) device_.queue().write(*arrays_.memory.buffer(), word * place, values, bytes);
    };
    (write(arrays.second, arrays.first.data(), arrays.first.size() * sizeof(T)), ...);
}

void ShapeStore::add(const std::shared_ptr<const Shape>& shape) {
    if (const auto found = entries_.find(shape.get()); found != entries_.end()) {
        ++found->second.users;
        return;
    }
    // Entered last: a shape too large for the device has no entry, and leaves at most unused elements in the arrays.
    Entry entry{shape, 0, 1};
    upload(entry, accelerators_of(*shape));
    order_.reserve(order_.size() + 1);
    plain_ += entries_.emplace(shape.get(), entry).first->second.plain ? 1 : 0;
    order_.push_back(shape.get());
}

void ShapeStore::remove(const Shape* shape) {
    const auto found = entries_.find(shape);
    if (--found->second.users > 0) return;
    bytes_dropped_ += found->second.bytes;
    plain_ -= found->second.plain ? 1 : 0;
    order_.erase(std::find(order_.begin(), order_.end(), shape));
    entries_.erase(found);
}

bool ShapeStore::pack() {
    if (whole_ && 2 * bytes_dropped_ <= bytes_used_) return false;
    arrays_ = {};
    headers_.clear();
    bytes_used_ = bytes_dropped_ = 0;
    whole_ = false; // if an upload throws, the next call begins anew
    for (const Shape* shape : order_) {
        Entry& entry = entries_.at(shape);
        plain_ -= entry.plain ? 1 : 0;
        entry.plain = false;
        upload(entry, accelerators_of(*shape));
        plain_ += entry.plain ? 1 : 0;
    }
    whole_ = true;
    return true;
}

// What was dropped there, or made of a shape since the last step, is taken as it is there: both pack and take over in
// the same calls from now on.
void ShapeStore::add_all_of(const ShapeStore& other) {
    std::vector<const Entry*> entries(other.headers_.size(), nullptr);
    for (const auto& [shape, entry] : other.entries_) entries[entry.index] = &entry;
    for (const Entry* from : entries) {
        if (from == nullptr) {
            const kernels::ShapeHeader dropped{};
            arrays_.headers.append(device_, std::span(&dropped, 1));
            headers_.push_back(dropped);
            continue;
        }
        Entry entry = *from;
        upload(entry, from->plain ? nullptr : accelerators_of(*from->shape));
        entry.bytes = from->bytes;
        entries_.emplace(entry.shape.get(), entry);
    }
    order_ = other.order_;
    bytes_used_ = other.bytes_used_;
    bytes_dropped_ = other.bytes_dropped_;
    plain_ = other.plain_;
    whole_ = other.whole_;
}

void ShapeStore::upload(Entry& entry, const Accelerators* more) {
    const ShapeData& data = entry.shape->data();
    kernels::ShapeHeader header = more != nullptr ? more->header : data.header;
    if (!device_.traits().shares_memory) {
        static const std::vector<kernels::uint> none;
        copy(array(data.nodes, header.nodes), array(data.triangle_blocks, header.triangle_blocks),
             array(data.faces, header.faces), array(data.face_normals, header.face_normals),
             array(data.vertex_blocks, header.vertex_blocks), array(data.clusters, header.clusters),
             array(data.components, header.components),
             array(more != nullptr ? more->clearances : data.clearances, header.clearances),
             array(more != nullptr ? more->outside_cells : none, header.outside_cells));
        header.normal_cones = 0; // of no use there
    }
    headers_.reserve(headers_.size() + 1);
    arrays_.headers.append(device_, std::span(&header, 1));
    entry.index = static_cast<kernels::uint>(headers_.size());
    headers_.push_back(header);
    entry.bytes = entry.shape->memory_bytes();
    bytes_used_ += entry.bytes;
    entry.plain = more == nullptr;
}

void ShapeStore::accelerate() {
    if (plain_ == 0) return;
    for (const Shape* shape : order_) {
        Entry& entry = entries_.at(shape);
        if (!entry.plain || accelerators_of(*shape) == nullptr) continue;
        upload_accelerators(entry, *accelerators_of(*shape));
        entry.plain = false;
        --plain_;
    }
}

// What was copied stays; the word of the grid of one cell is unused from now on.
void ShapeStore::upload_accelerators(Entry& entry, const Accelerators& more) {
    kernels::ShapeHeader header = more.header;
    if (!device_.traits().shares_memory) {
        const kernels::ShapeHeader& before = headers_[entry.index];
        header.nodes = before.nodes;
        header.triangle_blocks = before.triangle_blocks;
        header.faces = before.faces;
        header.face_normals = before.face_normals;
        header.vertex_blocks = before.vertex_blocks;
        header.clusters = before.clusters;
        header.components = before.components;
        copy(array(more.clearances, header.clearances), array(more.outside_cells, header.outside_cells));
        header.normal_cones = 0;
    }
    device_.queue().write(*arrays_.headers.buffer(), entry.index * sizeof header, &header, sizeof header);
    headers_[entry.index] = header;
    bytes_used_ += more.bytes();
    entry.bytes += more.bytes();
}

} // namespace raycontact
