// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/files.h>

#include <raycontact/error.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace raycontact::bench {

namespace {

void write_file(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw InputError(file.string() + ": cannot be written; name another folder with --out");
}

} // namespace

std::string heading(const Machine& m) {
    return fmt::format("{}, {}, {} cores, governor {}, load {:.2f}; built by {} from {}\n", m.date, m.cpu, m.cores,
                       m.governor, m.load, m.compiler, m.commit);
}

nlohmann::ordered_json machine_json(const Machine& m) {
    return {{"date", m.date},         {"commit", m.commit},     {"cpu", m.cpu},  {"cores", m.cores},
            {"compiler", m.compiler}, {"governor", m.governor}, {"load", m.load}};
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

std::filesystem::path write_csv(const std::filesystem::path& folder, const Machine& machine, const std::string& name,
                                const std::string& csv) {
    const std::filesystem::path where = folder / machine.slug;
    std::error_code error;
    std::filesystem::create_directories(where, error);
    if (error) throw InputError("--out " + folder.string() + ": cannot be made a folder; name another");
    std::filesystem::path file = where / (name + "-" + machine.date + ".csv");
    write_file(file, csv);
    return file;
}

std::filesystem::path write_both(const std::filesystem::path& folder, const Machine& machine, const std::string& name,
                                 const std::string& csv, const std::string& svg) {
    std::filesystem::path file = write_csv(folder, machine, name, csv);
    write_file(std::filesystem::path(file).replace_extension(".svg"), svg);
    return file;
}

} // namespace raycontact::bench
