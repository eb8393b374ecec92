// SPDX-License-Identifier: Apache-2.0
#ifdef RAYCONTACT_3MF
#include "mesh/zip_file.h"

#include <algorithm>
#include <array>
#include <unzip.h>

namespace raycontact {

void ZipFile::Close::operator()(void* zip) const {
    unzClose(zip);
}

ZipFile::ZipFile(const InputFile& file) : file_(file), source_{file.bytes, 0} {
    zlib_filefunc64_def memory{};
    memory.opaque = &source_;
    memory.zopen64_file = [](void* source, const void*, int) { return source; };
    memory.zread_file = [](void*, void* stream, void* to, uLong size) -> uLong {
        auto& [all, at] = *static_cast<Bytes*>(stream);
        const std::size_t count = std::min<std::size_t>(size, all.size() - at);
        std::copy_n(all.data() + at, count, static_cast<char*>(to));
        at += count;
        return count;
    };
    memory.zwrite_file = [](void*, void*, const void*, uLong) -> uLong { return 0; };
    memory.ztell64_file = [](void*, void* stream) -> ZPOS64_T { return static_cast<Bytes*>(stream)->at; };
    memory.zseek64_file = [](void*, void* stream, ZPOS64_T offset, int origin) -> long {
        auto& [all, at] = *static_cast<Bytes*>(stream);
        const std::uint64_t from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                                   : origin == ZLIB_FILEFUNC_SEEK_CUR ? at
                                                                      : all.size();
        if (offset > all.size() - from) return -1;
        at = from + offset;
        return 0;
    };
    memory.zclose_file = [](void*, void*) { return 0; };
    memory.zerror_file = [](void*, void*) { return 0; };
    zip_.reset(unzOpen2_64(nullptr, &memory));
    if (!zip_) file.fail("is no ZIP archive, as 3MF files are; it is truncated or damaged");
    for (int state = unzGoToFirstFile(zip_.get()); state == UNZ_OK; state = unzGoToNextFile(zip_.get())) {
        std::array<char, 1024> name{};
        unz64_file_pos place{};
        if (unzGetCurrentFileInfo64(zip_.get(), nullptr, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) != UNZ_OK
            || unzGetFilePos64(zip_.get(), &place) != UNZ_OK)
            break;
        parts_.emplace(key_of(name.data()), std::pair(place.pos_in_zip_directory, place.num_of_file));
    }
}

std::string ZipFile::key_of(std::string_view name) {
    name.remove_prefix(std::min(name.find_first_not_of('/'), name.size()));
    return lower_case(std::string(name));
}

void ZipFile::read(const std::string& key, const std::function<void(std::string_view)>& take) {
    const std::string part = printable(key.substr(0, 100));
    const auto found = parts_.find(key);
    if (found == parts_.end()) file_.fail("has no part " + part + "; it is no whole 3MF file, export it again");
    const unz64_file_pos place{found->second.first, found->second.second};
    unz_file_info64 info{};
    const auto damaged = [&] { file_.fail(part + ": is damaged in the ZIP archive; export it again"); };
    if (unzGoToFilePos64(zip_.get(), &place) != UNZ_OK
        || unzGetCurrentFileInfo64(zip_.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK)
        damaged();
    if ((info.flag & 1) != 0) file_.fail(part + ": is encrypted; save it without a password");
    if (info.compression_method != 0 && info.compression_method != Z_DEFLATED)
        file_.fail(part + ": is packed by method " + std::to_string(info.compression_method)
                   + "; 3MF files are deflated or stored");
    if (unzOpenCurrentFile(zip_.get()) != UNZ_OK) damaged();
    // A few kilobytes can hold gigabytes of nothing. Files of meshes shrink to a tenth, those of regular ones to a
    // thirtieth.
    constexpr std::size_t always = 1u << 26, for_a_byte = 100;
    const std::size_t most = std::max(always, for_a_byte * file_.bytes.size());
    std::array<char, 65536> piece{};
    int count = 0;
    while ((count = unzReadCurrentFile(zip_.get(), piece.data(), piece.size())) > 0) {
        bytes_ += static_cast<std::size_t>(count);
        if (bytes_ > most)
            file_.fail("unpacks to more than " + std::to_string(most) + " bytes from "
                       + std::to_string(file_.bytes.size()) + "; it is damaged, or split it");
        take({piece.data(), static_cast<std::size_t>(count)});
    }
    if (count < 0 || unzCloseCurrentFile(zip_.get()) != UNZ_OK) damaged(); // it has looked at the checksum
}

} // namespace raycontact
#endif
