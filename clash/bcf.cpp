// SPDX-License-Identifier: Apache-2.0
#include <clash/bcf.h>

#include "mesh/measure.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <zip.h>

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace raycontact::clash {

namespace {

/// Characters that XML does not have, and bytes that are no UTF-8, become U+FFFD.
std::string escaped(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
        const unsigned first = byte(i);
        const std::size_t length = first < 0x80       ? 1
                                   : first >> 5 == 6  ? 2
                                   : first >> 4 == 14 ? 3
                                   : first >> 3 == 30 ? 4
                                                      : 0;
        std::uint32_t code = length == 1 ? first : first & (0x7fu >> length);
        bool valid = length > 0;
        for (std::size_t k = 1; k < length; ++k) {
            valid = valid && byte(i + k) >> 6 == 2;
            code = code << 6 | (byte(i + k) & 0x3f);
        }
        constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
        valid = valid && code >= least[length] && code <= 0x10ffff && (code < 0xd800 || code > 0xdfff) && code != 0xfffe
                && code != 0xffff && (code >= 0x20 || code == '\t' || code == '\n' || code == '\r');
        if (!valid) {
            out += "\xef\xbf\xbd";
            ++i;
            continue;
        }
        if (code == '<' || code == '>' || code == '&' || code == '"' || code < 0x20)
            out += fmt::format("&#{};", code);
        else
            out += text.substr(i, length);
        i += length;
    }
    return out;
}

/// Of a text, always the same (as a name-based UUID, version 8).
std::string uuid(const std::string& text) {
    const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
    return fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", hash.high64 >> 32, hash.high64 >> 16 & 0xffff,
                       hash.high64 & 0xfff, 0x8000 | (hash.low64 >> 48 & 0x3fff), hash.low64 & 0xffffffffffff);
}

std::string three(std::string_view element, const Vec3& v) {
    return fmt::format("<{0}><X>{1}</X><Y>{2}</Y><Z>{3}</Z></{0}>", element, v.x, v.y, v.z);
}

constexpr const char* declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

std::string length_text(double length, const BcfOptions& options) {
    return fmt::format("{:.6g} {}", length, options.unit);
}

std::string markup(const std::string& guid, const std::string& view, std::size_t index, const std::string& title,
                   const std::string& label, const Clash& c, const BcfOptions& options) {
    std::string description = to_string(c.kind);
    if (c.kind == ClashKind::nearby)
        description += ", apart by " + length_text(c.distance, options);
    else if (!c.depth)
        description += ", no depth";
    else if (*c.depth > 0)
        description += ", depth " + length_text(*c.depth, options);
    if (c.volume) description += fmt::format(", volume {:.6g} {}^3", *c.volume, options.unit);
    return fmt::format(
        "{}<Markup><Topic Guid=\"{}\" TopicType=\"Clash\" TopicStatus=\"Open\"><Title>{}</Title><Index>{}</Index>"
        "<Labels>{}</Labels>{}<CreationDate>{}</CreationDate><CreationAuthor>raycontact</CreationAuthor>"
        "<Description>{}</Description></Topic><Viewpoints Guid=\"{}\"><Viewpoint>viewpoint.bcfv</Viewpoint>"
        "</Viewpoints></Markup>\n",
        declaration, guid, escaped(title), index, to_string(c.kind),
        label.empty() ? std::string() : "<Labels>" + escaped(label) + "</Labels>", options.date, escaped(description),
        view);
}

// From the south-west and above, as far as some sizes of what clashes; z is up in BCF.
std::string viewpoint(const std::string& view, const Clash& c, double size, const BcfOptions& options) {
    const Vec3 direction = unit(Vec3{1, 1, -0.8}), up = unit(Vec3{0.8, 0.8, 2});
    const Vec3 at = options.metres * c.point;
    return fmt::format("{}<VisualizationInfo Guid=\"{}\"><PerspectiveCamera>{}{}{}<FieldOfView>60</FieldOfView>"
                       "</PerspectiveCamera></VisualizationInfo>\n",
                       declaration, view, three("CameraViewPoint", at - (2 * options.metres * size) * direction),
                       three("CameraDirection", direction), three("CameraUpVector", up));
}

/// A ZIP archive in memory.
class Zip {
public:
    Zip() {
        zlib_filefunc64_def memory{};
        memory.opaque = this;
        memory.zopen64_file = [](void* zip, const void*, int) { return zip; };
        memory.zread_file = [](void*, void*, void*, uLong) -> uLong { return 0; };
        memory.zwrite_file = [](void*, void* stream, const void* from, uLong size) -> uLong {
            Zip& own = *static_cast<Zip*>(stream);
            own.bytes_.resize(std::max<std::size_t>(own.bytes_.size(), own.at_ + size));
            std::copy_n(static_cast<const char*>(from), size, own.bytes_.data() + own.at_);
            own.at_ += size;
            return size;
        };
        memory.ztell64_file = [](void*, void* stream) -> ZPOS64_T { return static_cast<Zip*>(stream)->at_; };
        memory.zseek64_file = [](void*, void* stream, ZPOS64_T offset, int origin) -> long {
            Zip& own = *static_cast<Zip*>(stream);
            own.at_ = offset
                      + (origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                         : origin == ZLIB_FILEFUNC_SEEK_CUR ? own.at_
                                                            : own.bytes_.size());
            return 0;
        };
        memory.zclose_file = [](void*, void*) { return 0; };
        memory.zerror_file = [](void*, void*) { return 0; };
        archive_ = zipOpen2_64(nullptr, APPEND_STATUS_CREATE, nullptr, &memory);
        check(archive_ != nullptr);
    }
    ~Zip() {
        if (archive_ != nullptr) zipClose(archive_, nullptr);
    }
    Zip(const Zip&) = delete;
    Zip& operator=(const Zip&) = delete;

    void add(const std::string& name, const std::string& bytes) {
        constexpr uLong utf8_names = 1u << 11;
        zip_fileinfo always{}; // the same clashes make the same bytes
        always.tmz_date.tm_year = 1980;
        always.tmz_date.tm_mday = 1;
        check(zipOpenNewFileInZip4_64(archive_, name.c_str(), &always, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                                      Z_DEFAULT_COMPRESSION, 0, -MAX_WBITS, DEF_MEM_LEVEL, Z_DEFAULT_STRATEGY, nullptr,
                                      0, 0, utf8_names, 0)
              == ZIP_OK);
        check(zipWriteInFileInZip(archive_, bytes.data(), static_cast<unsigned>(bytes.size())) == ZIP_OK);
        check(zipCloseFileInZip(archive_) == ZIP_OK);
    }

    std::string close() {
        check(zipClose(std::exchange(archive_, nullptr), nullptr) == ZIP_OK);
        return std::move(bytes_);
    }

private:
    static void check(bool done) {
        if (!done) throw std::runtime_error("the BCF file cannot be made");
    }

    std::string bytes_;
    std::size_t at_ = 0;
    zipFile archive_ = nullptr;
};

/// How much the viewer should see: the overlap, or a share of the smaller part.
double seen_size(const Clash& c, const std::vector<double>& sizes) {
    constexpr double least_share = 0.2;
    const double smaller = std::min(sizes[c.a], sizes[c.b]);
    return std::max(least_share * smaller, c.box ? length(c.box->high - c.box->low) : 0);
}

} // namespace

std::string bcf_zip(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes,
                    const BcfOptions& options) {
    std::map<const Mesh*, double> of_mesh;
    std::vector<double> sizes;
    for (const AssemblyPart& part : parts) {
        const auto [at, is_new] = of_mesh.try_emplace(part.mesh.get(), 0.0);
        if (is_new && !part.mesh->vertices.empty()) {
            const Box box = box_of(part.mesh->vertices);
            at->second = length(box.high - box.low);
        }
        sizes.push_back(at->second);
    }
    std::vector<std::pair<std::string, std::string>> files{
        {"bcf.version",
         std::string(declaration) + "<Version VersionId=\"2.1\"><DetailedVersion>2.1</DetailedVersion></Version>\n"}};
    std::vector<std::string> labels(clashes.size());
    for (const ClashGroup& group : options.groups)
        for (const std::size_t i : group.clashes) labels[i] = group.b.empty() ? group.a : group.a + " x " + group.b;
    for (std::size_t i = 0; i < clashes.size(); ++i) {
        const Clash& c = clashes[i];
        const std::string title = parts[c.a].name + " x " + parts[c.b].name;
        const std::string guid = uuid(parts[c.a].name + '\n' + parts[c.b].name), view = uuid(guid);
        files.emplace_back(guid + "/markup.bcf", markup(guid, view, i, title, labels[i], c, options));
        files.emplace_back(guid + "/viewpoint.bcfv", viewpoint(view, c, seen_size(c, sizes), options));
    }
    Zip zip;
    for (const auto& [name, bytes] : files) zip.add(name, bytes);
    return zip.close();
}

} // namespace raycontact::clash
