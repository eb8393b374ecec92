// SPDX-License-Identifier: Apache-2.0
#include "program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace {

std::string read_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

} // namespace

StartedProgram::StartedProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                               const std::string& out_file, const std::vector<std::string>& launcher)
    : out_file_(out_file) {
    const std::string out = out_file.empty() ? (streams_.path() / "out").string() : out_file;
    const std::string err = (streams_.path() / "err").string();

    std::vector<std::string> words = launcher;
    words.emplace_back(RAYCONTACT_PROGRAM_FILE);
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawnattr_t attributes; // a test that runs in the background may have them ignored
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int error = posix_spawn(&process_, words[0].c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error("cannot start " + words[0]);
}

StartedProgram::~StartedProgram() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
}

bool StartedProgram::listens(int signal) const {
    // Masks of the signals that are caught and ignored, in hexadecimal; none once it has ended.
    std::ifstream status("/proc/" + std::to_string(process_) + "/status");
    std::uint64_t mask = 0;
    bool ended = !status;
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("State:\tZ")) ended = true;
        if (line.starts_with("SigCgt:") || line.starts_with("SigIgn:"))
            mask |= std::stoull(line.substr(8), nullptr, 16);
    }
    return ended || signal == SIGKILL || (mask >> (signal - 1) & 1U) != 0;
}

void StartedProgram::send(int signal) const {
    while (!listens(signal)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (::kill(process_, signal) != 0) throw std::runtime_error("kill failed");
}

ProgramResult StartedProgram::wait() {
    int state = 0;
    if (waitpid(process_, &state, 0) != process_) throw std::runtime_error("waitpid failed");
    process_ = -1;
    ProgramResult result;
    result.status = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
    if (out_file_.empty()) result.out = read_text(streams_.path() / "out");
    result.err = read_text(streams_.path() / "err");
    return result;
}

ProgramResult run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                          const std::string& out_file) {
    return StartedProgram(arguments, folder, out_file).wait();
}

ProgramResult run_limited(const std::string& limit, const std::vector<std::string>& arguments,
                          const std::filesystem::path& folder) {
    return StartedProgram(arguments, folder, {}, {"/bin/sh", "-c", "ulimit " + limit + "; exec \"$0\" \"$@\""}).wait();
}

std::string cube_obj() {
    return "v -0.5 -0.5 -0.5\nv 0.5 -0.5 -0.5\nv 0.5 0.5 -0.5\nv -0.5 0.5 -0.5\n"
           "v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv 0.5 0.5 0.5\nv -0.5 0.5 0.5\n"
           "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

std::set<std::string> keys_of(const nlohmann::json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

std::vector<nlohmann::json> json_lines(const std::string& text) {
    std::vector<nlohmann::json> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
    return lines;
}

std::vector<std::map<std::string, double>> csv_rows(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line, cell;
    std::vector<std::string> names;
    std::getline(stream, line);
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
    std::vector<std::map<std::string, double>> rows;
    while (std::getline(stream, line)) {
        std::istringstream cells(line);
        auto& row = rows.emplace_back();
        std::size_t k = 0;
        for (; std::getline(cells, cell, ','); ++k) row[names.at(k)] = std::stod(cell);
        if (k != names.size()) throw std::runtime_error("a short line in " + file.string() + ": " + line);
    }
    return rows;
}

double sum_of(const std::vector<std::map<std::string, double>>& rows, const std::string& column) {
    double sum = 0;
    for (const auto& row : rows) sum += row.at(column);
    return sum;
}

double largest_of(const std::vector<std::map<std::string, double>>& rows, const std::string& column) {
    double most = 0;
    for (const auto& row : rows) most = std::max(most, row.at(column));
    return most;
}
