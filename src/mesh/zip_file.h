// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace raycontact {

/// The parts of a package (OPC): a ZIP archive in memory.
class ZipFile {
public:
    /// Throws InputError, as read() does, which names the file and the part.
    explicit ZipFile(const InputFile& file);

    /// As other parts of the package name it: small letters, without a slash before it.
    static std::string key_of(std::string_view name);

    /// Calls take() with one piece of the part after the other. All that is read of an archive is bounded by its size.
    void read(const std::string& key, const std::function<void(std::string_view)>& take);

    /// That were read so far, unpacked.
    std::size_t bytes() const { return bytes_; }

private:
    struct Bytes {
        std::string_view all;
        std::uint64_t at;
    };
    struct Close {
        void operator()(void* zip) const;
    };

    const InputFile& file_;
    Bytes source_;
    std::unique_ptr<void, Close> zip_;
    std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> parts_; ///< where the directory has them
    std::size_t bytes_ = 0;
};

} // namespace raycontact
