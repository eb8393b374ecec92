// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace raycontact::cuda {

/// What was compiled, kept in files from run to run, in $RAYCONTACT_CACHE, else $XDG_CACHE_HOME/raycontact, else
/// ~/.cache/raycontact (%LOCALAPPDATA%\raycontact on Windows). It never fails: what cannot be read, or was damaged, is
/// not there.
class Cache {
public:
    Cache();

    std::optional<std::string> load(const std::string& name) const;
    void store(const std::string& name, const std::string& bytes) const;

private:
    std::string folder_; ///< empty: nothing is kept
};

} // namespace raycontact::cuda
