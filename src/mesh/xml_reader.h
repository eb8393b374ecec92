// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct XML_ParserStruct;

namespace raycontact {

/// Reads an XML file of which only elements and attributes matter, piece by piece. Names are "namespace|name" where
/// they have a namespace. Errors name the part of the package and the line. Document types, and so entities, are
/// refused.
class XmlReader {
public:
    class Attributes {
    public:
        explicit Attributes(const char* const* list) : list_(list) {}
        std::optional<std::string_view> find(std::string_view name) const;

    private:
        const char* const* list_;
    };

    XmlReader(const InputFile& file, std::string part);
    XmlReader(const XmlReader&) = delete;
    XmlReader& operator=(const XmlReader&) = delete;
    virtual ~XmlReader();

    void feed(std::string_view piece) { parse(piece, false); }
    void finish() { parse({}, true); }

protected:
    virtual void begin(std::string_view name, const Attributes& attributes) = 0;
    virtual void end() {}
    /// Comes before the element that declares it.
    virtual void declare(std::string_view /*prefix*/, std::string_view /*name_space*/) {}

    std::size_t line() const;
    [[noreturn]] void fail(const std::string& what) const { fail_at(line(), what); }
    [[noreturn]] void fail_at(std::size_t line, const std::string& what) const;
    /// The attribute `name` as one number, or throws.
    double number(const Attributes& attributes, std::string_view name) const;
    std::uint32_t whole(const Attributes& attributes, std::string_view name) const;
    double number(std::string_view word, std::string_view name) const;

private:
    struct Callbacks;
    void parse(std::string_view piece, bool last);
    std::string_view needed(const Attributes& attributes, std::string_view name) const;

    const InputFile& file_;
    std::string part_;
    std::unique_ptr<XML_ParserStruct, void (*)(XML_ParserStruct*)> parser_;
    std::size_t fed_ = 0, depth_ = 0;
    std::exception_ptr error_; ///< thrown in a callback: Expat is C
};

} // namespace raycontact
