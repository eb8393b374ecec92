// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "interruption.h"
#include "mesh/input_file.h"
#include "mesh/nonfinite_vertices.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact {

/// Reads the words of a text file and counts its lines; every error names the line. Lines end in \n, \r\n or \r.
/// NUL and Ctrl-Z at the end of the file are padding.
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

    /// The rest of this line without blanks around it; comments and joined lines are not looked for.
    std::string_view rest_of_line();

    /// Reads a word as a finite number, or throws an error about `what`.
    double number(std::string_view word, const char* what) const;
    /// The same, where it need not be finite.
    double any_number(std::string_view word, const char* what) const;
    /// Reads a word as a whole number that fits, or throws an error about `what`.
    std::int64_t integer(std::string_view word, const char* what) const;
    /// Three coordinates on this line, which must be finite.
    Vec3 point_on_line();
    /// Appends the three coordinates on this line; where one is not finite the vertex is told.
    void vertex_on_line(std::vector<Vec3>& vertices, NonfiniteVertices& nonfinite);
    /// Reads the rest of this line as numbers, finite or not, or throws an error about `what`; returns how many there
    /// are.
    std::size_t numbers_on_line(const char* what);

    char comment = '\n';      ///< starts a comment (OBJ and OFF '#')
    bool joins_lines = false; ///< a backslash that ends a line, blanks behind it or not, joins it with the next (OBJ)

    std::size_t line() const { return line_; }
    /// Bytes at the end of the file that are not read.
    std::size_t padding() const { return file_.bytes.size() - static_cast<std::size_t>(end_ - file_.bytes.data()); }
    std::size_t offset() const { return static_cast<std::size_t>(at_ - file_.bytes.data()); }
    [[noreturn]] void fail(const std::string& what) const { file_.fail_at(line_, what); }

private:
    bool joins(const char* backslash) const;
    bool is_comment(const char* at) const;
    void skip_blanks();

    const InputFile& file_;
    const char* at_;
    const char* end_;
    std::size_t line_ = 1;
    InterruptionCheck check_;
};

} // namespace raycontact
