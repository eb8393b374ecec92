// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/user_memory.h>

#include <string_view>

namespace raycontact {

/// What a contact says (Contact), as a column of an array for all contacts: type, numbers a contact.
enum class ContactColumn {
    slots,      ///< uint32, 2: BodyId::slot of bodies a and b
    bodies,     ///< uint32, 4: slot and generation of body a, of body b
    key,        ///< uint64: Contact::key()
    kind,       ///< uint8: FeatureKind
    source,     ///< uint8: Side
    indices,    ///< uint32, 2: of the feature on a and on b
    is_new,     ///< uint8
    point_a,    ///< float64, 3, or float32; metres, world frame
    point_b,    ///< float64, 3, or float32
    normal,     ///< float32, 3
    depth,      ///< float32, metres
    ray_length, ///< float32, metres
    weight,     ///< float32
};

/// A column that is wanted, and where: contiguous, the contacts in their order (by the slots of their bodies, then by
/// key).
struct ContactOutput {
    ContactColumn column;                    ///< which
    UserMemory memory;                       ///< with room for all contacts
    NumberType points = NumberType::float64; ///< of point_a and point_b
};

/// Throws InputError naming what is known.
RAYCONTACT_API ContactColumn contact_column_from(std::string_view word);
/// The word that contact_column_from() takes for it.
RAYCONTACT_API std::string_view to_string(ContactColumn);
/// Bytes of a contact in such a column.
RAYCONTACT_API std::size_t bytes_of(ContactColumn column, NumberType points = NumberType::float64);

} // namespace raycontact
