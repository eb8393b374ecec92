// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact {

/// Walks over the words of a text file and knows its line; every complaint names it. Lines end in \n, \r\n or \r.
class TextScanner {
public:
    TextScanner(const InputFile& file, std::size_t start, std::size_t line);

    /// The next word of this line, empty at its end. With a comment mark, the rest of the line from it on is skipped.
    std::string_view word_on_line();
    /// The next word of the file, empty at its end.
    std::string_view word();
    /// To the start of the next line; false at the end of the file.
    bool next_line();
    bool at_end();

    /// Reads a word as a finite number, or complains about `what`.
    double number(std::string_view word, const char* what) const;
    /// Reads a word as a whole number that fits, or complains about `what`.
    std::int64_t integer(std::string_view word, const char* what) const;
    /// Three finite numbers on this line.
    Vec3 point_on_line(const char* what);

    /// A character that starts a comment (OBJ and OFF '#'), and one that joins lines (OBJ '\\'); 0 for none.
    char comment = 0;
    char joiner = 0;

    std::size_t line() const { return line_; }
    std::size_t offset() const { return static_cast<std::size_t>(at_ - file_.bytes.data()); }
    [[noreturn]] void fail(const std::string& what) const { file_.fail_at(line_, what); }

private:
    const InputFile& file_;
    const char* at_;
    const char* end_;
    std::size_t line_;
};

} // namespace raycontact
