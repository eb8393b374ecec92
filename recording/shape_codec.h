// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/bytes.h>

#include <raycontact/shape.h>

#include <memory>
#include <span>

namespace raycontact::recording {

/// A prepared mesh from which Shape::make makes this very shape again, bit for bit; that is tried before it returns.
/// Throws std::runtime_error where it does not.
PreparedMesh remade_mesh(const Shape& shape);

/// Of a ball or capsule its measures.
Bytes encode_shape(const Shape& shape);
/// The very shape. Throws Damage for bytes that are none.
std::shared_ptr<const Shape> decode_shape(std::span<const unsigned char> bytes);

Bytes encode_mesh(const PreparedMesh& mesh);
/// Throws Damage for bytes that are no mesh.
PreparedMesh decode_mesh(std::span<const unsigned char> bytes);

} // namespace raycontact::recording
