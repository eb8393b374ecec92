// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

/// The folder of `--out`, made before the work, which takes minutes: one that cannot be written should be known at
/// once. Throws InputError naming it.
void make_out_folder(const std::string& folder);

/// Throws InputError naming the file when it cannot be written.
void write_out(const std::string& folder, const std::string& name, const std::string& text);
