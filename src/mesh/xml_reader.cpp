// SPDX-License-Identifier: Apache-2.0
#ifdef RAYCONTACT_3MF
#include "mesh/xml_reader.h"

#include "interruption.h"

#include <charconv>
#include <cmath>
#include <expat.h>
#include <new>
#include <system_error>
#include <utility>

namespace raycontact {

namespace {

std::string_view trimmed(std::string_view word) {
    constexpr std::string_view blanks = " \t\r\n";
    word.remove_prefix(std::min(word.find_first_not_of(blanks), word.size()));
    return word.substr(0, word.find_last_not_of(blanks) + 1);
}

} // namespace

/// What Expat calls. Nothing may be thrown through it.
struct XmlReader::Callbacks {
    template <class Call>
    static void guarded(void* user, Call&& call) {
        XmlReader& reader = *static_cast<XmlReader*>(user);
        if (reader.error_) return;
        try {
            InterruptionCheck()();
            call(reader);
        } catch (...) {
            reader.error_ = std::current_exception();
            XML_StopParser(reader.parser_.get(), XML_FALSE);
        }
    }
    static void begin(void* user, const char* name, const char** attributes) {
        guarded(user, [&](XmlReader& reader) {
            constexpr std::size_t deepest = 64; // Expat keeps something for each level
            if (++reader.depth_ > deepest)
                reader.fail("its elements lie more than " + std::to_string(deepest) + " deep in one another");
            reader.begin(name, Attributes(attributes));
        });
    }
    static void end(void* user, const char*) {
        guarded(user, [](XmlReader& reader) {
            --reader.depth_;
            reader.end();
        });
    }
    static void declare(void* user, const char* prefix, const char* name_space) {
        guarded(user, [&](XmlReader& reader) {
            reader.declare(prefix ? prefix : std::string_view(), name_space ? name_space : std::string_view());
        });
    }
    static void document_type(void* user, const char*, const char*, const char*, int) {
        guarded(user, [](XmlReader& reader) { reader.fail("declares a document type, which 3MF forbids"); });
    }
};

std::optional<std::string_view> XmlReader::Attributes::find(std::string_view name) const {
    for (const char* const* at = list_; at[0]; at += 2)
        if (name == at[0]) return at[1];
    return std::nullopt;
}

XmlReader::XmlReader(const InputFile& file, std::string part)
    : file_(file), part_(std::move(part)), parser_(XML_ParserCreateNS(nullptr, '|'), &XML_ParserFree) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &Callbacks::begin, &Callbacks::end);
    XML_SetStartNamespaceDeclHandler(parser_.get(), &Callbacks::declare);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &Callbacks::document_type);
}

XmlReader::~XmlReader() = default;

std::size_t XmlReader::line() const {
    return XML_GetCurrentLineNumber(parser_.get());
}

void XmlReader::fail_at(std::size_t line, const std::string& what) const {
    file_.fail(part_ + ": line " + std::to_string(line) + ": " + what);
}

void XmlReader::parse(std::string_view piece, bool last) {
    const XML_Status status = XML_Parse(parser_.get(), piece.data(), static_cast<int>(piece.size()), last ? 1 : 0);
    if (error_) std::rethrow_exception(error_);
    if (status != XML_STATUS_OK) {
        const XML_Error code = XML_GetErrorCode(parser_.get());
        if (code == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
        fail(std::string("is damaged: ") + XML_ErrorString(code));
    }
    // Expat reads what it has of a tag anew with each piece: of one without an end that takes for ever.
    constexpr std::size_t longest = 1u << 20;
    fed_ += piece.size();
    const XML_Index begun = XML_GetCurrentByteIndex(parser_.get());
    if (begun >= 0 && fed_ - static_cast<std::size_t>(begun) > longest)
        fail("has a tag of more than " + std::to_string(longest) + " bytes; it is damaged");
}

std::string_view XmlReader::needed(const Attributes& attributes, std::string_view name) const {
    if (const auto found = attributes.find(name)) return *found;
    fail("has no " + std::string(name));
}

double XmlReader::number(std::string_view word, std::string_view name) const {
    word = trimmed(word);
    const std::string_view digits = word.substr(word.starts_with('+') && !word.starts_with("+-") ? 1 : 0);
    double value = 0;
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || last != digits.data() + digits.size())
        fail(std::string(name) + " " + in_quotes(word) + " is not a number");
    if (error != std::errc() || !std::isfinite(value))
        fail(std::string(name) + " " + in_quotes(word) + " is not finite, or too close to 0");
    return value;
}

double XmlReader::number(const Attributes& attributes, std::string_view name) const {
    return number(needed(attributes, name), name);
}

std::uint32_t XmlReader::whole(const Attributes& attributes, std::string_view name) const {
    const std::string_view word = trimmed(needed(attributes, name));
    std::uint32_t value = 0;
    const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || last != word.data() + word.size())
        fail(std::string(name) + " " + in_quotes(word) + " is not a whole number from 0 to 4294967295");
    return value;
}

} // namespace raycontact
#endif
