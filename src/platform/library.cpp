// SPDX-License-Identifier: Apache-2.0
#include "platform/library.h"

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace raycontact::platform {

#ifdef _WIN32

// Never from the current folder, where anyone may have left a library of that name. What a library given by its path
// needs may lie beside it.
Library::Library(const std::filesystem::path& name) {
    const bool is_path = name.has_parent_path();
    std::error_code error;
    const std::filesystem::path place = is_path ? std::filesystem::absolute(name, error) : name;
    const DWORD folders = LOAD_LIBRARY_SEARCH_DEFAULT_DIRS | (is_path ? LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR : 0);
    handle_ = LoadLibraryExW(place.c_str(), nullptr, folders);
}

Library::Symbol Library::symbol(const char* name) const {
    return reinterpret_cast<Symbol>(GetProcAddress(static_cast<HMODULE>(handle_), name));
}

#else

Library::Library(const std::filesystem::path& name) : handle_(dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) {}

Library::Symbol Library::symbol(const char* name) const {
    return reinterpret_cast<Symbol>(dlsym(handle_, name));
}

#endif

} // namespace raycontact::platform
