// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../temporary_folder.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// What the program left behind.
struct ProgramResult {
    int status = -1; ///< exit status; 128 + signal when it was killed
    std::string out, err;
};

/// The built program (no shell), running in `folder` from the start; killed where nobody waits for it.
class StartedProgram {
public:
    StartedProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                   const std::string& out_file = {}, const std::vector<std::string>& launcher = {});
    ~StartedProgram();
    StartedProgram(const StartedProgram&) = delete;
    StartedProgram& operator=(const StartedProgram&) = delete;
    void send(int signal) const; ///< as soon as the program listens to it
    ProgramResult wait();

private:
    bool listens(int signal) const;
    TemporaryFolder streams_;
    std::string out_file_;
    int process_ = -1;
};

/// Runs the built program (no shell) in `folder` and waits. `out_file`: where stdout goes instead of
/// ProgramResult::out.
ProgramResult run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                          const std::string& out_file = {});

/// The same under a shell's `ulimit` with these words, "-f 16".
ProgramResult run_limited(const std::string& limit, const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder);

/// A cube of edge 1 about the origin: 8 vertices, 12 triangles, closed, outward.
std::string cube_obj();

/// The keys of a JSON object.
std::set<std::string> keys_of(const nlohmann::json& object);

/// A table of numbers with a line of names: each row by name.
std::vector<std::map<std::string, double>> csv_rows(const std::filesystem::path& file);
double sum_of(const std::vector<std::map<std::string, double>>& rows, const std::string& column);
double largest_of(const std::vector<std::map<std::string, double>>& rows, const std::string& column);

/// Every line as JSON.
std::vector<nlohmann::json> json_lines(const std::string& text);
