// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>
#include <raycontact/shape.h>

/// Says on stderr that a mesh has edges so long that, with Features::vertices, they can cross another mesh unseen.
void warn_if_coarse(const raycontact::Shape& shape, const raycontact::Settings& settings);
