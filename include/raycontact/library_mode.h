// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>

#include <cstddef> // any header of the standard library says which one it is

// With _GLIBCXX_DEBUG the containers of libstdc++ are other types of other sizes. A program and a library that do not
// agree on it would crash; here they do not link, and the linker's message says why.
#ifdef __GLIBCXX__
#ifdef _GLIBCXX_DEBUG
#define RAYCONTACT_MODE(name) name##_with_GLIBCXX_DEBUG
#else
#define RAYCONTACT_MODE(name) name##_without_GLIBCXX_DEBUG
#endif

namespace raycontact {

RAYCONTACT_API extern const bool RAYCONTACT_MODE(library_built); ///< the library has the one that it was built with
[[gnu::used]] inline const bool* const RAYCONTACT_MODE(library_needed) = &RAYCONTACT_MODE(library_built);

} // namespace raycontact
#endif
