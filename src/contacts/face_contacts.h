// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"

#include <raycontact/contact.h>
#include <raycontact/settings.h>

#include <span>
#include <vector>

namespace raycontact {

/// With direction `weighted` and features `edges`, what two closed bodies share as contacts of their faces, in place of
/// those of vertices and edges (docs/internals/patches.md). It works on the host for every device, each pair alone.
class FaceContacts {
public:
    /// contacts: of some pairs, all of each, sorted; so are those that it leaves.
    void run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies,
             std::vector<Contact>& contacts);
    void trim();

private:
    std::vector<std::vector<Contact>> slices_; ///< of some pairs in a row each
};

} // namespace raycontact
