// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/unit/mesh/formats.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <zlib.h>

namespace raycontact::test {

// Writers of 3MF packages for tests.

using Parts = std::vector<std::pair<std::string, std::string>>; ///< names and contents

inline std::string deflated(const std::string& bytes) {
    z_stream stream{};
    if (deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data())); // zlib's type; it only reads
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int state = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (state != Z_STREAM_END) throw std::runtime_error("zlib could not deflate");
    return out;
}

inline std::string zip_of(const Parts& parts, bool packed = true) {
    std::string out, directory;
    for (const auto& [name, bytes] : parts) {
        const std::string data = packed ? deflated(bytes) : bytes;
        std::string common; // of both headers
        put(common, std::uint16_t{20});
        put(common, std::uint16_t{0});
        put(common, std::uint16_t(packed ? 8 : 0));
        put(common, std::uint32_t{0x21 << 16}); // 1980-01-01
        put(common, static_cast<std::uint32_t>(
                        crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()))));
        put(common, static_cast<std::uint32_t>(data.size()));
        put(common, static_cast<std::uint32_t>(bytes.size()));
        put(common, static_cast<std::uint16_t>(name.size()));
        put(common, std::uint16_t{0});
        directory += std::string("PK\1\2") + std::string("\x14\0", 2) + common + std::string(10, '\0');
        put(directory, static_cast<std::uint32_t>(out.size()));
        directory += name;
        out += "PK\3\4" + common + name + data;
    }
    std::string end = std::string("PK\5\6") + std::string(4, '\0');
    for (int i = 0; i < 2; ++i) put(end, static_cast<std::uint16_t>(parts.size()));
    put(end, static_cast<std::uint32_t>(directory.size()));
    put(end, static_cast<std::uint32_t>(out.size()));
    return out + directory + end + std::string(2, '\0');
}

/// The root model, and parts beside it.
inline Parts parts_3mf(const std::string& model, const Parts& more = {}) {
    Parts parts{
        {"_rels/.rels",
         R"(<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)"},
        {"3D/3dmodel.model", model}};
    parts.insert(parts.end(), more.begin(), more.end());
    return parts;
}

/// attributes: of the model, its unit among them.
inline std::string model_3mf(const std::string& resources, const std::string& build,
                             const std::string& attributes = R"(unit="meter")") {
    return R"(<?xml version="1.0" encoding="UTF-8"?>
<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" )"
           + attributes + ">\n<resources>\n" + resources + "</resources>\n<build>\n" + build + "</build>\n</model>\n";
}

/// attributes: the object's, its id among them.
inline std::string object_3mf(const Mesh& mesh, const std::string& attributes) {
    std::string out = "<object " + attributes + "><mesh>\n<vertices>\n";
    for (const Vec3& v : mesh.vertices)
        out += R"(<vertex x=")" + text(v.x) + R"(" y=")" + text(v.y) + R"(" z=")" + text(v.z) + "\"/>\n";
    out += "</vertices>\n<triangles>\n";
    for (const auto& [a, b, c] : mesh.triangles)
        out += R"(<triangle v1=")" + std::to_string(a) + R"(" v2=")" + std::to_string(b) + R"(" v3=")"
               + std::to_string(c) + "\"/>\n";
    return out + "</triangles>\n</mesh></object>\n";
}

inline std::string as_3mf(const Mesh& mesh) {
    return zip_of(parts_3mf(model_3mf(object_3mf(mesh, R"(id="1")"), R"(<item objectid="1"/>)")));
}

} // namespace raycontact::test
