// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a shared library shows: everything else in it is hidden. Nested types of a shown class are shown as well, unless
// they are marked RAYCONTACT_HIDDEN.
#if defined(__GNUC__) && !defined(_WIN32)
#define RAYCONTACT_API __attribute__((visibility("default")))
#define RAYCONTACT_HIDDEN __attribute__((visibility("hidden")))
#else
#define RAYCONTACT_API
#define RAYCONTACT_HIDDEN
#endif
