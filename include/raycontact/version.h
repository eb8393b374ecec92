// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The version of these headers, for `#if`: 10000 x major + 100 x minor + patch.
#define RAYCONTACT_VERSION 200
