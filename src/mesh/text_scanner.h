// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact {

/// Reads the words of a text file and counts its lines; every error names the line. Lines end in \n, \r\n or \r.
class TextScanner {
public:
    explicit TextScanner(const InputFile& file);

    /// The next word of this line, empty at its end. With a comment mark, the rest of the line from it on is skipped.
    std::string_view word_on_line();
    /// The next word of the file, empty at its end.
    std::string_view word();
    /// To the start of the next line; false at the end of the file.
    bool next_line();
    /// Whether nothing but blanks and comments is left. Moves to the next word.
    bool at_end();

    /// Reads a word as a finite number, or throws an error about `what`.
    double number(std::string_view word, const char* what) const;
    /// Reads a word as a whole number that fits, or throws an error about `what`.
    std::int64_t integer(std::string_view word, const char* what) const;
    /// Three coordinates on this line.
    Vec3 point_on_line();
    /// Reads the rest of this line as numbers, or throws an error about `what`; returns how many there are.
    std::size_t numbers_on_line(const char* what);

    char comment = '\n';      ///< starts a comment (OBJ and OFF '#')
    bool joins_lines = false; ///< a backslash at the end of a line joins it with the next (OBJ)

    std::size_t line() const { return line_; }
    std::size_t offset() const { return static_cast<std::size_t>(at_ - file_.bytes.data()); }
    [[noreturn]] void fail(const std::string& what) const { file_.fail_at(line_, what); }

private:
    bool joins(const char* backslash) const;
    void skip_blanks();

    const InputFile& file_;
    const char* at_;
    const char* end_;
    std::size_t line_ = 1;
};

} // namespace raycontact
