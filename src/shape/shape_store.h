// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"
#include "shape/shape_data.h"

#include <raycontact/shape.h>

#include <unordered_map>
#include <utility>
#include <vector>

namespace raycontact {

/// The shapes in use by one scene. A device that shares the host's memory reads their own arrays; for another they are
/// copied, one after the other. Counts the users of each; a shape without users is dropped when the store is next
/// packed.
class ShapeStore {
public:
    struct Arrays {
        Array<kernels::ShapeHeader> headers;
        Array<kernels::ulong> memory; ///< the shapes' arrays, where they are copied
    };

    explicit ShapeStore(Device& device) : device_(device) {}

    void add(const std::shared_ptr<const Shape>& shape);
    /// The shapes of another store, each with the index and the users that it has there: for one that has none yet.
    void add_all_of(const ShapeStore& other);
    void remove(const Shape* shape);
    /// Index of a shape in the arrays. Valid until the next add or pack.
    kernels::uint index_of(const Shape* shape) const { return entries_.at(shape).index; }
    /// Frees the memory of dropped shapes once they outweigh the rest. Indices change when it returns true, or throws:
    /// then another call must follow before any shape is used.
    bool pack();
    /// Takes over what was made of the shapes since they were added (Shape::prepare). Call it between steps.
    void accelerate();
    /// How many shapes have no accelerators here.
    std::size_t plain() const { return plain_; }
    const Arrays& arrays() const { return arrays_; }
    /// The host's copy of arrays().headers.
    std::span<const kernels::ShapeHeader> headers() const { return headers_; }

private:
    struct Entry {
        std::shared_ptr<const Shape> shape;
        kernels::uint index = 0;
        std::uint32_t users = 0;
        std::uint64_t bytes = 0; ///< of the shape, as far as it is here
        bool plain = false;      ///< without accelerators here
    };
    void upload(Entry& entry, const Accelerators* more);
    void upload_accelerators(Entry& entry, const Accelerators& more);
    template <class... T>
    void copy(const std::pair<const std::vector<T>&, kernels::ulong&>&... arrays);

    Device& device_;
    std::unordered_map<const Shape*, Entry> entries_;
    std::vector<const Shape*> order_; ///< of upload, so that no result depends on addresses
    Arrays arrays_;
    std::vector<kernels::ShapeHeader> headers_;
    std::uint64_t bytes_used_ = 0, bytes_dropped_ = 0;
    std::size_t plain_ = 0; ///< entries
    bool whole_ = true;     ///< all shapes of order_ are in the arrays
};

} // namespace raycontact
