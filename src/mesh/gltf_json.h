// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

namespace raycontact {

/// Throws InputError unless the JSON of a glTF or GLB file is sound and its indices, counts and offsets are whole
/// numbers.
void check_gltf_json(const InputFile& file);

} // namespace raycontact
