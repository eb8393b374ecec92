// SPDX-License-Identifier: Apache-2.0
#include <report/machine.h>

#include <commit.h>
#include <fmt/format.h>

#include <cctype>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

namespace raycontact::report {

namespace {

std::string cpu_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const auto colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string first_line(const char* file) {
    std::ifstream in(file);
    std::string line;
    return std::getline(in, line) && !line.empty() ? line : "unknown";
}

std::string today() {
    const std::time_t seconds = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
    return text;
}

/// Lower-case letters and digits, everything else one dash.
std::string slug_of(const std::string& text) {
    std::string slug;
    for (const char c : text) {
        if (std::isalnum(static_cast<unsigned char>(c)))
            slug += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (!slug.empty() && slug.back() != '-')
            slug += '-';
    }
    return slug;
}

} // namespace

Machine this_machine() {
    Machine machine;
    machine.date = today();
    machine.commit = RAYCONTACT_COMMIT;
    machine.cpu = cpu_name();
    machine.cores = std::thread::hardware_concurrency();
#if defined(__clang__)
    machine.compiler = "clang " __clang_version__;
#else
    machine.compiler = "gcc " __VERSION__;
#endif
    machine.governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
    double load = 0;
    if (getloadavg(&load, 1) == 1) machine.load = load;
    machine.slug = slug_of(machine.cpu + " " + std::to_string(machine.cores));
    return machine;
}

std::string heading(const Machine& m, bool with_load) {
    return fmt::format("{}, {}, {} cores, governor {}{}; built by {} from {}{}\n", m.date, m.cpu, m.cores, m.governor,
                       with_load ? fmt::format(", load {:.2f}", m.load) : "", m.compiler, m.commit,
                       m.cut_short ? "; cut short" : "");
}

} // namespace raycontact::report
