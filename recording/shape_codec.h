// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/bytes.h>

#include <raycontact/shape.h>

#include <span>

namespace raycontact::recording {

/// A prepared mesh from which Shape::make makes this very shape again, bit for bit; that is tried before it returns.
/// Throws std::runtime_error where it does not.
PreparedMesh remade_mesh(const Shape& shape);

Bytes encode_mesh(const PreparedMesh& mesh);
/// Throws Damage for bytes that are no mesh.
PreparedMesh decode_mesh(std::span<const unsigned char> bytes);

} // namespace raycontact::recording
