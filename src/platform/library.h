// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <type_traits>

namespace raycontact::platform {

/// A shared library, loaded at run time. It stays for as long as the process lives, so to load it again takes no time.
class Library {
public:
    /// By its path, or by a name that the system's loader looks for.
    explicit Library(const std::filesystem::path& name);

    /// Whether it is there and can be loaded.
    explicit operator bool() const { return handle_ != nullptr; }
    /// Sets `function` to that of this name, to null if there is none. Whoever calls vouches for the type.
    template <typename Function>
    void find(const char* name, Function*& function) const {
        static_assert(std::is_function_v<Function>);
        function = reinterpret_cast<Function*>(symbol(name));
    }

private:
    using Symbol = void (*)();
    Symbol symbol(const char* name) const;

    void* handle_;
};

} // namespace raycontact::platform
