// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace raycontact::bench {

nlohmann::ordered_json machine_json(const Machine& m) {
    return {{"date", m.date},         {"commit", m.commit},     {"cpu", m.cpu},   {"cores", m.cores},
            {"compiler", m.compiler}, {"governor", m.governor}, {"load", m.load}, {"cut_short", m.cut_short}};
}

std::string quoted(const std::string& text) {
    std::string field = "\"";
    for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + '"';
}

std::string machine_fields(const Machine& m) {
    return fmt::format("{},{},{},{},{},{},{:.2f}", m.date, m.commit, quoted(m.cpu), m.cores, quoted(m.compiler),
                       m.governor, m.load);
}

std::filesystem::path results_folder(const std::filesystem::path& folder, const Machine& machine) {
    return folder / machine.slug;
}

std::string result_name(const Machine& machine, const std::string& name, const std::string& ending) {
    return name + "-" + machine.date + ending;
}

void write_both(output::OutFolder& folder, const Machine& machine, const std::string& name, const std::string& csv,
                const std::string& svg) {
    folder.write(result_name(machine, name, ".csv"), csv);
    folder.write(result_name(machine, name, ".svg"), svg);
}

} // namespace raycontact::bench
